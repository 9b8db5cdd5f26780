// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plvo/host/files/line_file.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/report/svg.hpp"

namespace plvo::report {
namespace {

constexpr double kPlotWidth = 1200, kChartWidth = 520, kChartHeight = 240, kChartGap = 70;
constexpr double kLeftColumn = 60, kRightColumn = 650;
constexpr double kLegendTop = 62, kLegendLine = 20;
constexpr std::size_t kMostPoints = 1500;  // of a curve: more than the picture has columns
constexpr Colour kInk = {26, 29, 33}, kFaint = {102, 112, 128}, kGrid = {221, 225, 231};

using Curve = std::vector<PlotPoint>;  // values, not pixels

struct PlotCurve {
  std::vector<Curve> pieces;
  Colour colour;
  double width = 1.8;
  bool dashed = false;
  bool dots = false;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Limits2d {
  double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low, y_low = x_low, y_high = -x_low;
  void include(PlotPoint p) {
    x_low = std::min(x_low, p.x);
    x_high = std::max(x_high, p.x);
    y_low = std::min(y_low, p.y);
    y_high = std::max(y_high, p.y);
  }
};

Limits2d limits_of(const std::vector<PlotCurve>& curves) {
  Limits2d limits;
  for (const PlotCurve& curve : curves)
    for (const Curve& piece : curve.pieces)
      for (const PlotPoint& p : piece) limits.include(p);
  if (!(limits.x_low <= limits.x_high)) limits = {0, 1, 0, 1};
  return limits;
}

// Splits a list of points where the step of their stamps exceeds 2.5 of the median, as eval finds lost
// frames. Of each run of `points / kMostPoints` points the one with the largest y is kept, so that peaks
// stay.
std::vector<Curve> pieces_of(const std::vector<std::int64_t>& stamps_ns, const Curve& points) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) steps.push_back(stamps_ns[i] - stamps_ns[i - 1]);
  std::int64_t median_ns = 0;
  if (!steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    median_ns = *middle;
  }
  const std::size_t run = points.size() / kMostPoints + 1;
  std::vector<Curve> pieces(1);
  std::size_t kept = 0;  // points of the current run
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && 2 * (stamps_ns[i] - stamps_ns[i - 1]) > 5 * median_ns) {
      pieces.emplace_back();
      kept = 0;
    }
    if (kept == 0) {
      pieces.back().push_back(points[i]);
    } else if (points[i].y > pieces.back().back().y) {
      pieces.back().back() = points[i];
    }
    kept = (kept + 1) % run;
  }
  return pieces;
}

// Axes x_axis, y_axis of a chart in `box` with their marks, then the curves.
void draw_chart(Svg& svg, const Box& box, const std::string& title, const std::string& x_unit,
                const std::vector<PlotCurve>& curves, const Axis& x_axis, const Axis& y_axis) {
  const double bottom = box.y + box.height, right = box.x + box.width;
  svg.text({box.x, box.y - 10}, title, 14, kInk);
  for (const auto& [value, text] : y_axis.marks(5)) {
    const double y = y_axis.at(value);
    svg.line({box.x, y}, {right, y}, kGrid, 1);
    svg.text({box.x - 6, y + 4}, text, 11, kFaint, Svg::Anchor::kEnd);
  }
  for (const auto& [value, text] : x_axis.marks(6)) {
    const double x = x_axis.at(value);
    svg.line({x, bottom}, {x, bottom + 4}, kFaint, 1);
    svg.text({x, bottom + 17}, text, 11, kFaint, Svg::Anchor::kMiddle);
  }
  svg.text({right, bottom + 33}, x_unit, 11, kFaint, Svg::Anchor::kEnd);
  svg.line({box.x, bottom}, {right, bottom}, kFaint, 1);
  for (const PlotCurve& curve : curves) {
    for (const Curve& piece : curve.pieces) {
      Curve pixels;
      for (const PlotPoint& p : piece) pixels.push_back({x_axis.at(p.x), y_axis.at(p.y)});
      svg.polyline(pixels, curve.colour, curve.width, curve.dashed);
      if (curve.dots || pixels.size() == 1)
        for (const PlotPoint& p : pixels) svg.disc(p, 3, curve.colour);
    }
  }
}

PlotCurve curve_of(std::size_t estimate) {
  PlotCurve curve;
  curve.colour = kCurves[estimate % kCurves.size()];
  curve.dashed = estimate / kCurves.size() % 2 == 1;
  return curve;
}

// The two axes of the world along which the truth extends furthest, in increasing order.
std::array<int, 2> widest_axes(const std::vector<Se3>& truth) {
  Vector3 low = truth.front().t, high = low;
  for (const Se3& T : truth) {
    low = low.cwiseMin(T.t);
    high = high.cwiseMax(T.t);
  }
  Eigen::Index least = 0;
  (high - low).minCoeff(&least);
  return {least == 0 ? 1 : 0, least == 2 ? 1 : 2};
}

Curve projected(const std::vector<Se3>& poses, const Se3& T, const std::array<int, 2>& axes) {
  Curve points;
  for (const Se3& pose : poses) {
    const Vector3 p = T * pose.t;
    points.push_back({p[axes[0]], p[axes[1]]});
  }
  return points;
}

void draw_trajectories(Svg& svg, const Box& box, const std::vector<PlottedEstimate>& estimates) {
  const eval::Evaluation* longest = estimates.front().evaluation;
  for (const PlottedEstimate& e : estimates)
    if (e.evaluation->poses.truth.size() > longest->poses.truth.size()) longest = e.evaluation;
  const std::array<int, 2> axes = widest_axes(longest->poses.truth);
  std::vector<PlotCurve> curves(1);
  curves[0].pieces = pieces_of(longest->poses.stamps_ns, projected(longest->poses.truth, Se3(), axes));
  curves[0].colour = kInk;
  curves[0].width = 3;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const eval::Evaluation& e = *estimates[i].evaluation;
    curves.push_back(curve_of(i));
    curves.back().pieces =
        pieces_of(e.poses.stamps_ns, projected(e.poses.estimate, e.ate.T_truth_estimate, axes));
  }
  // Equal scales of both axes: the smaller range is widened about its middle.
  const Limits2d limits = limits_of(curves);
  const double per_px = 1.08 * std::max({(limits.x_high - limits.x_low) / box.width,
                                         (limits.y_high - limits.y_low) / box.height, 1e-4 / box.width});
  const double x = 0.5 * (limits.x_low + limits.x_high), y = 0.5 * (limits.y_low + limits.y_high);
  const double half_width = 0.5 * per_px * box.width, half_height = 0.5 * per_px * box.height;
  const std::string names = "xyz";
  const std::string right = names.substr(static_cast<std::size_t>(axes[0]), 1);
  const std::string up = names.substr(static_cast<std::size_t>(axes[1]), 1);
  draw_chart(svg, box, "trajectory, best fit to the truth: " + up + " over " + right + ", m", right + ", m",
             curves, Axis(x - half_width, x + half_width, box.x, box.x + box.width),
             Axis(y - half_height, y + half_height, box.y + box.height, box.y));
}

// Charts whose vertical axis starts at 0.
void draw_from_zero(Svg& svg, const Box& box, const std::string& title, const std::string& x_unit,
                    const std::vector<PlotCurve>& curves, Axis::Scale scale) {
  const Limits2d limits = limits_of(curves);
  draw_chart(svg, box, title, x_unit, curves,
             Axis(limits.x_low, limits.x_high, box.x, box.x + box.width, scale),
             Axis(0, limits.y_high > 0 ? 1.05 * limits.y_high : 1, box.y + box.height, box.y));
}

// Errors of position (m) or orientation (rad), times `factor`, over time.
std::vector<PlotCurve> errors_over_time(const std::vector<PlottedEstimate>& estimates, bool orientation,
                                        double factor) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  for (const PlottedEstimate& e : estimates)
    first_ns = std::min(first_ns, e.evaluation->poses.stamps_ns.front());
  std::vector<PlotCurve> curves;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const eval::Evaluation& e = *estimates[i].evaluation;
    Curve points;
    for (const eval::PoseError& error : e.errors) {
      const Vector3 part = orientation ? error.error.tail<3>() : error.error.head<3>();
      points.push_back({static_cast<double>(error.stamp_ns - first_ns) * 1e-9, factor * part.norm()});
    }
    curves.push_back(curve_of(i));
    curves.back().pieces = pieces_of(e.poses.stamps_ns, points);
  }
  return curves;
}

std::vector<PlotCurve> errors_over_distance(const std::vector<PlottedEstimate>& estimates, bool rotation) {
  std::vector<PlotCurve> curves;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    curves.push_back(curve_of(i));
    curves.back().dots = true;
    Curve& piece = curves.back().pieces.emplace_back();
    for (const eval::DistanceError& d : estimates[i].evaluation->by_distance)
      piece.push_back({d.length_m, rotation ? d.rotation_deg_per_m.mean : d.translation_percent.mean});
  }
  return curves;
}

void draw_legend(Svg& svg, const std::vector<PlottedEstimate>& estimates) {
  const auto entry = [&svg](std::size_t row, const PlotCurve& curve, const std::string& text) {
    const double y = kLegendTop + kLegendLine * static_cast<double>(row);
    svg.polyline({{kLeftColumn, y - 4}, {kLeftColumn + 30, y - 4}}, curve.colour, curve.width + 1,
                 curve.dashed);
    svg.text({kLeftColumn + 40, y}, text, 13, kInk);
  };
  PlotCurve truth;
  truth.colour = kInk;
  entry(0, truth, "ground truth");
  for (std::size_t i = 0; i < estimates.size(); ++i) entry(i + 1, curve_of(i), estimates[i].label);
}

}  // namespace

std::string make_plot(const std::string& title, const std::vector<PlottedEstimate>& estimates) {
  const double top = kLegendTop + kLegendLine * static_cast<double>(estimates.size()) + 50;
  const double middle = top + kChartHeight + kChartGap, bottom = middle + kChartHeight + kChartGap;
  Svg svg(kPlotWidth, bottom + kChartHeight + 50);
  svg.text({kLeftColumn, 34}, title, 18, kInk);
  draw_legend(svg, estimates);
  const auto box = [](double x, double y, double height) { return Box{x, y, kChartWidth, height}; };
  draw_trajectories(svg, box(kLeftColumn, top, middle + kChartHeight - top), estimates);
  draw_from_zero(svg, box(kRightColumn, top, kChartHeight), "position error since the first pose, mm", "s",
                 errors_over_time(estimates, false, 1e3), Axis::Scale::kLinear);
  draw_from_zero(svg, box(kRightColumn, middle, kChartHeight),
                 "orientation error since the first pose, degrees", "s",
                 errors_over_time(estimates, true, 180 / kPi), Axis::Scale::kLinear);
  draw_from_zero(svg, box(kLeftColumn, bottom, kChartHeight), "RPE over distance, translation, mean, %",
                 "m travelled", errors_over_distance(estimates, false), Axis::Scale::kLogarithmic);
  draw_from_zero(svg, box(kRightColumn, bottom, kChartHeight),
                 "RPE over distance, rotation, mean, degrees per m", "m travelled",
                 errors_over_distance(estimates, true), Axis::Scale::kLogarithmic);
  return std::move(svg).finish();
}

Status write_plot(const std::filesystem::path& path, const std::string& title,
                  const std::vector<PlottedEstimate>& estimates) {
  LineFile file;
  return file.open(path, make_plot(title, estimates));
}

}  // namespace plvo::report
