// SPDX-License-Identifier: Apache-2.0
// A keypoint of one pyramid level, with the data needed to find it in another frame. The features of a frame
// do not refer to its image, so a reference can be kept indefinitely at a fixed memory cost.
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
  std::int16_t x = 0, y = 0;  // whole pixel of its level at which it was found
  std::uint8_t level = 0;
  float strength = 0;  // smaller eigenvalue of the mean structure tensor, (grey levels / px)²
};

// 256 comparisons, see descriptor.hpp.
using Descriptor = std::array<std::uint64_t, 4>;

// Raw pixels around (x, y) on the keypoint's level: the window that alignment.hpp compares, and a rim for its
// smoothing and its gradients.
inline constexpr int kPatchRadius = 5;
inline constexpr int kPatchSide = 2 * kPatchRadius + 1;
using Patch = std::array<std::uint8_t, kPatchSide * kPatchSide>;

// The registered part of a patch: columns −4 … 3 and rows −4 … 4 around its centre. The mask marks the pixels
// on the keypoint's own surface: one byte per row, one bit per column (depth_mask.hpp).
inline constexpr int kWindowReach = 4;
inline constexpr int kWindowColumns = 2 * kWindowReach;
inline constexpr int kWindowRows = 2 * kWindowReach + 1;
using WindowMask = std::array<std::uint8_t, kWindowRows>;

// The point features of one frame: parallel arrays, indexed by keypoint.
struct PointFeatures {
  FixedVector<Keypoint> keypoints;
  std::span<Descriptor> descriptors;
  std::span<Patch> patches;
  std::span<WindowMask> masks;
  std::span<Point3d> points;  // camera frame
  bool looked_for = false;
  bool described = false;
  int candidates = 0;  // found, before the selection of the keypoints

  // Resets to "not detected yet": no keypoints, and at most the given capacity.
  void clear(std::size_t capacity) {
    looked_for = described = false;
    candidates = 0;
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
