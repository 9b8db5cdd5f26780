// SPDX-License-Identifier: Apache-2.0
// A drawing as SVG 1.1: one file that loads nothing. Text from outside is escaped.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plvo/report/palette.hpp"

namespace plvo::report {

struct PlotPoint {
  double x = 0, y = 0;
};

class Svg {
 public:
  enum class Anchor { kStart, kMiddle, kEnd };

  Svg(double width, double height);

  void line(PlotPoint from, PlotPoint to, Colour colour, double width);
  // Draws nothing for fewer than two points. dashed: to tell curves of one colour apart.
  void polyline(const std::vector<PlotPoint>& points, Colour colour, double width, bool dashed = false);
  void disc(PlotPoint centre, double radius, Colour colour);
  void text(PlotPoint at, std::string_view text, double size, Colour colour, Anchor anchor = Anchor::kStart);

  std::string finish() &&;

 private:
  std::string out_;
};

// Axes of a chart: value ↔ pixel, with marks at round values.
class Axis {
 public:
  enum class Scale { kLinear, kLogarithmic };

  // The values low … high lie at the pixels from … to. An empty range is widened.
  Axis(double low, double high, double from, double to, Scale scale = Scale::kLinear);

  double at(double value) const;
  double low() const { return low_; }
  double high() const { return high_; }
  // About `count` round values with their text; logarithmic: 1, 2 and 5 times powers of ten.
  std::vector<std::pair<double, std::string>> marks(int count) const;

 private:
  double low_, high_, from_, to_;
  Scale scale_;
};

}  // namespace plvo::report
