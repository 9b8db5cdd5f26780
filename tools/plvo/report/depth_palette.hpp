// SPDX-License-Identifier: Apache-2.0
// Colour map of depth: red is near; yellow, green and cyan lead to blue, which is far.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace plvo::report {

constexpr double kDepthNear_m = 0.4;
constexpr double kDepthFar_m = 5.0;

// Returns red, green, blue.
constexpr std::array<std::uint8_t, 3> depth_colour(double depth_m) {
  const double h = 4 * std::clamp((depth_m - kDepthNear_m) / (kDepthFar_m - kDepthNear_m), 0.0, 1.0);
  const auto level = [](double v) { return static_cast<std::uint8_t>(255 * std::clamp(v, 0.0, 1.0)); };
  return {level(2 - h), level(h < 2 ? h : 4 - h), level(h - 2)};
}

}  // namespace plvo::report
