// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "plvo/host/printable.hpp"

namespace plvo::report {
namespace {

std::string svg_text(std::string_view text) {
  std::string safe;
  for (const char c : printable(text)) {
    switch (c) {
      case '&': safe += "&amp;"; break;
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      default: safe += c;
    }
  }
  return safe;
}

}  // namespace

Svg::Svg(double width, double height)
    : out_(fmt::format(
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
          "{1}\" font-family=\"sans-serif\">\n"
          "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
          width, height)) {}

void Svg::line(PlotPoint from, PlotPoint to, Colour colour, double width) {
  fmt::format_to(std::back_inserter(out_),
                 "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
                 "stroke-width=\"{}\"/>\n",
                 from.x, from.y, to.x, to.y, css_colour(colour), width);
}

void Svg::polyline(const std::vector<PlotPoint>& points, Colour colour, double width, bool dashed) {
  if (points.size() < 2) return;
  fmt::format_to(
      std::back_inserter(out_),
      "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} stroke-linejoin=\"round\" points=\"",
      css_colour(colour), width, dashed ? " stroke-dasharray=\"6 3\"" : "");
  for (const PlotPoint& p : points) fmt::format_to(std::back_inserter(out_), "{:.1f},{:.1f} ", p.x, p.y);
  out_ += "\"/>\n";
}

void Svg::disc(PlotPoint centre, double radius, Colour colour) {
  fmt::format_to(std::back_inserter(out_), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\"/>\n",
                 centre.x, centre.y, radius, css_colour(colour));
}

void Svg::text(PlotPoint at, std::string_view text, double size, Colour colour, Anchor anchor) {
  const char* const names[] = {"start", "middle", "end"};
  fmt::format_to(
      std::back_inserter(out_),
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{}\">{}</text>\n", at.x,
      at.y, size, css_colour(colour), names[static_cast<int>(anchor)], svg_text(text));
}

std::string Svg::finish() && { return std::move(out_) + "</svg>"; }

Axis::Axis(double low, double high, double from, double to, Scale scale)
    : low_(low), high_(high), from_(from), to_(to), scale_(scale) {
  if (scale_ == Scale::kLogarithmic) {
    low_ = std::log10(low_);
    high_ = std::log10(high_);
  }
  if (!(high_ - low_ > 1e-9)) {
    low_ -= 0.5;
    high_ += 0.5;
  }
}

double Axis::at(double value) const {
  if (scale_ == Scale::kLogarithmic) value = std::log10(value);
  return from_ + (value - low_) / (high_ - low_) * (to_ - from_);
}

std::vector<std::pair<double, std::string>> Axis::marks(int count) const {
  std::vector<std::pair<double, std::string>> marks;
  if (scale_ == Scale::kLogarithmic) {
    for (int power = static_cast<int>(std::floor(low_)); power <= high_ + 1e-9; ++power) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double value = factor * std::pow(10.0, power);
        if (std::log10(value) > low_ - 1e-9 && std::log10(value) < high_ + 1e-9)
          marks.emplace_back(value, fmt::format("{:g}", value));
      }
    }
    return marks;
  }
  const double raw = (high_ - low_) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= raw) step = factor * power;
  const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(low_ / step - 1e-9); k * step <= high_ + 1e-9 * step; ++k)
    marks.emplace_back(k * step, fmt::format("{:.{}f}", k == 0 ? 0.0 : k * step, digits));
  return marks;
}

}  // namespace plvo::report
