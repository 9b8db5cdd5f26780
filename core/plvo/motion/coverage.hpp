// SPDX-License-Identifier: Apache-2.0
// The evidence of features: the size of the part of the scene that they represent. A scene may contain more
// than one motion, and the camera's is that of the larger part of the scene, not that of the most features:
// an object or a part of the robot may have most of the texture, but it is smaller than the room. The image
// is divided into cells (image_cells.hpp). The evidence of a cell is its width at the depth of its features,
// and they share it. A line has the evidence of all cells that it spans. A landmark with a bad record has no
// evidence.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "plvo/camera/observation.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/motion/image_cells.hpp"

namespace plvo {

// In a world at rest, the camera's motion mostly explains more than this share of the evidence of all
// matches: in four of five frames of the recordings, and in every frame of three rendered rooms.
inline constexpr double kWorldAtRest = 0.75;

// Evidence does not decide which of two motions is the camera's if one motion explains at least this share of
// the evidence that the other explains.
inline constexpr double kComparableShare = 0.8;
constexpr bool are_comparable(double evidence, double other) {
  return evidence > kComparableShare * other && other > kComparableShare * evidence;
}

// The part of the scene that a feature represents: its position in camera coordinates, z > 0, the length of
// its image in the plane z = 1 (0 for a point), and the record of its landmark.
struct Extent {
  Vector3 middle;
  double length = 0;
  LandmarkRecord record = LandmarkRecord();
};

inline Extent extent_of(const Point3d& point) { return {point.p, 0, point.record}; }
// Always inlined: used by code that is compiled for speed and by code that is compiled for size.
[[gnu::always_inline]] inline Extent extent_of(const Line3d& line) {
  const Vector3 image = line.b / line.b.z() - line.a / line.a.z();
  return {0.5 * (line.a + line.b), sqrt(image.squaredNorm()), line.record};
}

// The features of one frame. First count all of them, then ask for the evidence of each.
class Coverage {
 public:
  Coverage() { clear(); }
  void clear() { crowd_.fill(0); }
  void count(const Extent& extent) {
    if (!extent.record.trusted()) return;
    std::uint8_t& features = crowd_[ImageCells::at(extent.middle)];
    if (features < 255) ++features;
  }
  // Evidence of a feature: its depth in m, to which the width of its cell is proportional, times the cells of
  // a line, divided by the number of features in the cell. A feature that was not counted has its cell for
  // itself.
  double evidence(const Extent& extent) const {
    if (!extent.record.trusted()) return 0;
    const double cells = std::min(1 + extent.length / ImageCells::kWidth, kMostCellsOfALine);
    return extent.middle.z() * cells / std::max(crowd_[ImageCells::at(extent.middle)], std::uint8_t{1});
  }

 private:
  // A line counts as at most this many cells.
  static constexpr double kMostCellsOfALine = 4;

  std::array<std::uint8_t, ImageCells::kCount> crowd_;
};

}  // namespace plvo
