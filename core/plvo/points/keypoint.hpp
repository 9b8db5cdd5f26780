// SPDX-License-Identifier: Apache-2.0
// A keypoint of one pyramid level and what the other frame needs to find it again. The feature set of a frame
// owns no image: a reference can be kept for as long as one likes at a fixed price.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/camera/observation.hpp"

namespace plvo {

struct Keypoint {
  float u = 0, v = 0;         // level-0 pixels, sub-pixel
  std::int16_t x = 0, y = 0;  // the whole pixel of its level that it was found at
  std::uint8_t level = 0;
  float strength = 0;  // smaller eigenvalue of the mean structure tensor, (grey levels / px)²
};

// 256 comparisons, see descriptor.hpp.
using Descriptor = std::array<std::uint64_t, 4>;

// Raw pixels around (x, y) on the keypoint's level: what alignment.hpp compares with, and a rim for its
// smoothing and its gradients.
inline constexpr int kPatchRadius = 5;
inline constexpr int kPatchSide = 2 * kPatchRadius + 1;
using Patch = std::array<std::uint8_t, kPatchSide * kPatchSide>;

// The part of a patch that is registered, columns −4 … 3 and rows −4 … 4 about its centre, and which of its
// pixels show the keypoint's own surface: a byte a row, a bit a column (depth_mask.hpp).
inline constexpr int kWindowReach = 4;
inline constexpr int kWindowColumns = 2 * kWindowReach;
inline constexpr int kWindowRows = 2 * kWindowReach + 1;
using WindowMask = std::array<std::uint8_t, kWindowRows>;

// The point features of one frame: parallel arrays, index = keypoint.
struct PointFeatures {
  FixedVector<Keypoint> keypoints;
  std::span<Descriptor> descriptors;
  std::span<Patch> patches;
  std::span<WindowMask> masks;
  std::span<Point3d> points;  // camera frame
  bool looked_for = false;
  bool described = false;

  // Not looked for yet: no keypoints, and capacity for at most so many.
  void clear(std::size_t capacity) {
    looked_for = described = false;
    keypoints =
        FixedVector<Keypoint>({keypoints.begin(), capacity < points.size() ? capacity : points.size()});
  }

  constexpr void allocate(Arena& memory, int capacity) {
    const auto n = static_cast<std::size_t>(capacity);
    keypoints = FixedVector<Keypoint>(memory.take<Keypoint>("point features", n));
    descriptors = memory.take<Descriptor>("point features", n);
    patches = memory.take<Patch>("point features", n);
    masks = memory.take<WindowMask>("point features", n);
    points = memory.take<Point3d>("point features", n);
  }
};

}  // namespace plvo
