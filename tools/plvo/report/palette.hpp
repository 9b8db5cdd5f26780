// SPDX-License-Identifier: Apache-2.0
// The colours of every drawing: overlay, report, live page, plots. They are those of Okabe and Ito (Color
// Universal Design, 2008), which stay apart in protanopia, deuteranopia and tritanopia; palette_test computes
// how far apart they are in each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace plvo::report {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Colour&) const = default;
};

inline constexpr Colour kOrange = {230, 159, 0};
inline constexpr Colour kSkyBlue = {86, 180, 233};
inline constexpr Colour kGreen = {0, 158, 115};
inline constexpr Colour kYellow = {240, 228, 66};
inline constexpr Colour kBlue = {0, 114, 178};
inline constexpr Colour kVermilion = {213, 94, 0};
inline constexpr Colour kPurple = {204, 121, 167};
inline constexpr Colour kGrey = {153, 153, 153};

// Features on an image.
inline constexpr Colour kPointColour = kYellow;        // matched with the reference
inline constexpr Colour kLineColour = kSkyBlue;        // matched with the reference
inline constexpr Colour kLine3dColour = kBlue;         // lifted to 3D, unmatched
inline constexpr Colour kRejectedColour = kVermilion;  // matched, but inconsistent with the motion
inline constexpr Colour kSeenColour = kGrey;           // only detected

// Curves on a light ground, in this order.
inline constexpr std::array<Colour, 6> kCurves = {kBlue, kVermilion, kGreen, kPurple, kOrange, kSkyBlue};

// Depth: from near, light, to far, dark. The lightness falls all the way, so that no hue needs to be told.
inline constexpr double kDepthNear_m = 0.4;
inline constexpr double kDepthFar_m = 5.0;
inline constexpr std::array<Colour, 4> kDepthRamp = {kYellow, kGreen, kBlue, Colour{60, 30, 100}};

constexpr Colour depth_colour(double depth_m) {
  constexpr double kSteps = kDepthRamp.size() - 1;
  const double at = kSteps * std::clamp((depth_m - kDepthNear_m) / (kDepthFar_m - kDepthNear_m), 0.0, 1.0);
  const auto step = std::min(static_cast<std::size_t>(at), kDepthRamp.size() - 2);
  const double share = at - static_cast<double>(step);
  const Colour from = kDepthRamp[step], to = kDepthRamp[step + 1];
  const auto mix = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(a + share * (b - a) + 0.5);
  };
  return {mix(from.r, to.r), mix(from.g, to.g), mix(from.b, to.b)};
}

// "#rrggbb"
std::string css_colour(Colour colour);
// The palette as variables of a style sheet, for the pages: --point, --line, --line-3d, --rejected, --seen,
// --curve-0 …, --depth-ramp (a gradient from near to far).
std::string palette_css();

}  // namespace plvo::report
