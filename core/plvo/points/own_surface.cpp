// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/own_surface.hpp"

#include <array>

namespace plvo {
namespace {

// Pixels of the keypoint's level by which the own surface is shrunk: one for the gradient's reach, one for
// what colour and depth are apart.
constexpr int kRim = 2;
// A surface as steep as this changes so much of its depth over a window; what differs by more is another one.
constexpr double kSameSurface = 0.06;

constexpr int kSurfaceColumns = kWindowColumns + 2 * kRim;
constexpr int kSurfaceRows = kWindowRows + 2 * kRim;
using Row = std::uint16_t;  // a bit a column, kRim to either side of the window

}  // namespace

WindowMask own_surface(const DepthSampler& depth, const Vector2& centre, double depth_m, int level) {
  WindowMask mask{};
  // Rounded once, where the pixel lies inside: beside the image the same rounding would go towards it.
  const int centre_x = static_cast<int>(centre.x() + 0.5);
  const int centre_y = static_cast<int>(centre.y() + 0.5);
  if (!depth.inside(centre_x, centre_y)) return mask;
  constexpr int kReach = kWindowReach + kRim;
  const DepthSampler::Window readings(depth, centre_x, centre_y, kReach, 1 << level);
  // The depths that belong to it, in units of the image: at least one unit, for 0 means none.
  const double nearest = (1 - kSameSurface) * depth_m / depth.metres_per_unit();
  const double farthest = (1 + kSameSurface) * depth_m / depth.metres_per_unit();
  const auto first = static_cast<std::uint32_t>(nearest) + 1;
  const std::uint32_t count = static_cast<std::uint32_t>(farthest) - first + 1;
  std::array<Row, kSurfaceRows> own{};
  std::array<std::uint16_t, kSurfaceColumns> units;
  for (int r = 0; r < kSurfaceRows; ++r) {
    readings.read_row(r - kReach, units);
    std::uint32_t bits = 0;
    for (std::size_t c = units.size(); c-- > 0;)
      bits = bits << 1 | static_cast<std::uint32_t>(units[c] - first < count);  // below `first` it wraps
    own[static_cast<std::size_t>(r)] = static_cast<Row>(bits);
  }
  // Erosion by kRim in either direction: along the rows by shifts, then over neighbouring rows.
  for (Row& row : own) {
    Row shrunk = row;
    for (int i = 1; i <= 2 * kRim; ++i) shrunk &= static_cast<Row>(row >> i);
    row = shrunk;
  }
  for (std::size_t r = 0; r < mask.size(); ++r) {
    Row bits = own[r];
    for (std::size_t i = 1; i <= 2 * kRim; ++i) bits &= own[r + i];
    mask[r] = static_cast<std::uint8_t>(bits);
  }
  return mask;
}

}  // namespace plvo
