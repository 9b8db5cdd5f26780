// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/timing_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace plvo::calibrate {
namespace {

constexpr double kMs = 1e3;
// Size of a plot and its margins, px.
constexpr double kWidth = 420, kHeight = 240, kLeft = 48, kRight = 12, kTop = 12, kBottom = 34;

std::string found_text(const TimingResult& result, std::size_t i) {
  const double value_ms = kMs * value_of(result.timing, i);
  if (i == 2 && result.global_shutter) return "0: a global shutter agrees best";
  if (result.sigma_s[i] == 0) return fmt::format("{:.1f} ms, as given", value_ms);
  if (!is_determined(result, i)) return "not shown by these recordings; left as it was";
  return fmt::format("{:.2f} ms, SD {:.2f} ms", value_ms, kMs * result.sigma_s[i]);
}

constexpr const char* kStampSigmaKey = "stamp_sigma_s";

std::string stamps_text(const TimingResult& result) {
  return result.stamp_sigma_s < 0 ? "no constant frame rate in these recordings; left as it was"
                                  : fmt::format("{:.2f} ms", kMs * result.stamp_sigma_s);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else
      result += c;
  }
  return result;
}

// Draws one curve as SVG: the measured costs and the minimum found.
std::string drawing(const TimingResult& result, std::size_t i) {
  const std::vector<CurvePoint>& curve = result.curves[i];
  if (curve.size() < 2) return {};
  const auto range = std::minmax_element(
      curve.begin(), curve.end(),
      [](const CurvePoint& a, const CurvePoint& b) { return a.disagreement < b.disagreement; });
  const double lowest = range.first->disagreement;
  const double highest = range.second->disagreement;
  const double span_s = curve.back().seconds - curve.front().seconds;
  const double span = std::max(highest - lowest, 1e-9);
  const auto x = [&](double s) {
    return kLeft + (kWidth - kLeft - kRight) * (s - curve.front().seconds) / span_s;
  };
  const auto y = [&](double d) { return kTop + (kHeight - kTop - kBottom) * (highest - d) / span; };
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth,
                                kHeight, kTimingNames[i].what);
  const double found_x = x(value_of(result.timing, i));
  const double band =
      std::isfinite(result.sigma_s[i]) ? x(curve.front().seconds + 2 * result.sigma_s[i]) - kLeft : 0;
  fmt::format_to(std::back_inserter(svg),
                 "<rect class=\"band\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"/>\n",
                 found_x - band, kTop, 2 * band, kHeight - kTop - kBottom);
  fmt::format_to(std::back_inserter(svg),
                 "<line class=\"found\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\"/>\n", found_x,
                 kTop, kHeight - kBottom);
  svg += "<polyline points=\"";
  for (const CurvePoint& p : curve)
    fmt::format_to(std::back_inserter(svg), "{:.1f},{:.1f} ", x(p.seconds), y(p.disagreement));
  svg += "\"/>\n";
  for (const CurvePoint& p : curve)
    fmt::format_to(std::back_inserter(svg), "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", x(p.seconds),
                   y(p.disagreement));
  for (const double s : {curve.front().seconds, curve[curve.size() / 2].seconds, curve.back().seconds})
    fmt::format_to(std::back_inserter(svg),
                   "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.1f} ms</text>\n", x(s),
                   kHeight - 12, kMs * s);
  for (const double d : {lowest, highest})
    fmt::format_to(std::back_inserter(svg), "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.2f}</text>\n",
                   kLeft - 6, y(d) + 4, d);
  return svg + "</svg>\n";
}

constexpr const char* kStyle =
    ":root{color-scheme:light dark;--ink:#1a1d21;--line:#0b62d6;--band:#0b62d622;--found:#1a8f3c;--bg:#fff}"
    "@media(prefers-color-scheme:dark){:root{--ink:#e8eaed;--line:#5aa2ff;--band:#5aa2ff33;--found:#4fd07a;"
    "--bg:#14171b}}"
    "body{font:15px/1.4 system-ui,sans-serif;color:var(--ink);background:var(--bg);max-width:1320px;margin:0 "
    "auto;"
    "padding:12px}"
    "main{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(300px,1fr))}"
    "table{border-collapse:collapse}td,th{text-align:left;padding:3px 14px 3px 0}"
    "svg{width:100%}text{font-size:11px;fill:var(--ink)}polyline{fill:none;stroke:var(--line);stroke-width:2}"
    "circle{fill:var(--line)}.band{fill:var(--band)}.found{stroke:var(--found);stroke-width:2}";

}  // namespace

const std::array<TimingName, 3> kTimingNames = {{{"depth_delay_s", "depth is exposed after its stamp"},
                                                 {"depth_readout_s", "first to last row of depth"},
                                                 {"readout_s", "first to last row of colour"}}};

double value_of(const SensorTiming& t, std::size_t index) {
  return std::array{t.depth_delay_s, t.depth_readout_s, t.readout_s}[index];
}

bool is_determined(const TimingResult& result, std::size_t index) {
  return result.sigma_s[index] <= kMostSigma_s[index];
}

std::string to_text(const TimingResult& result) {
  std::string text = fmt::format("{} frames, {} pairs, {} passes{}; the camera turned {:.0f} deg/s\n",
                                 result.frames, result.pairs, result.passes.size(),
                                 result.settled ? "" : " (not settled)", kDegrees * result.turn_rad_per_s);
  for (std::size_t i = 0; i < 3; ++i)
    text += fmt::format("{:<16} {}\n", kTimingNames[i].key, found_text(result, i));
  return text + fmt::format("{:<16} {}\n", kStampSigmaKey, stamps_text(result));
}

nlohmann::ordered_json to_json(const TimingResult& result) {
  nlohmann::ordered_json json = {{"frames", result.frames},
                                 {"pairs", result.pairs},
                                 {"settled", result.settled},
                                 {"global_shutter", result.global_shutter},
                                 {"turn_deg_per_s", kDegrees * result.turn_rad_per_s}};
  for (std::size_t i = 0; i < 3; ++i) {
    nlohmann::ordered_json entry = {{"value", value_of(result.timing, i)},
                                    {"determined", is_determined(result, i)}};
    entry["sigma"] = std::isfinite(result.sigma_s[i]) ? nlohmann::ordered_json(result.sigma_s[i]) : nullptr;
    entry["curve"] = nlohmann::ordered_json::array();
    for (const CurvePoint& p : result.curves[i]) entry["curve"].push_back({p.seconds, p.disagreement});
    json[kTimingNames[i].key] = entry;
  }
  json[kStampSigmaKey] = result.stamp_sigma_s;
  if (result.stamp_sigma_s < 0) json[kStampSigmaKey] = nullptr;
  json["passes"] = nlohmann::ordered_json::array();
  for (const SensorTiming& t : result.passes)
    json["passes"].push_back({t.depth_delay_s, t.depth_readout_s, t.readout_s});
  return json;
}

std::string to_html(const TimingResult& result, const std::vector<std::string>& recordings) {
  std::string names;
  for (const std::string& name : recordings) names += (names.empty() ? "" : ", ") + escaped(name);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<title>Timing of the sensor</title><style>{}</style>\n<h1>Timing of the sensor</h1>\n"
      "<p>{}: {} frames, {} pairs, {} passes; the camera turned {:.0f} deg/s.</p>\n<table>\n",
      kStyle, names, result.frames, result.pairs, result.passes.size(), kDegrees * result.turn_rad_per_s);
  for (std::size_t i = 0; i < 3; ++i)
    page += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", kTimingNames[i].key,
                        kTimingNames[i].what, found_text(result, i));
  page += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", kStampSigmaKey,
                      "colour's stamps about an even pace, SD", stamps_text(result));
  page +=
      "</table>\n<p>How much points and lines of two frames disagree, against each of the three with the "
      "others as "
      "found: the mean squared error in units of its variance, truncated. The line is what was found, the "
      "band two "
      "standard deviations to either side.</p>\n<main>\n";
  for (std::size_t i = 0; i < 3; ++i)
    page += fmt::format("<section><h2>{}</h2>\n{}</section>\n", kTimingNames[i].key, drawing(result, i));
  return page + "</main></html>";
}

}  // namespace plvo::calibrate
