// SPDX-License-Identifier: Apache-2.0
// The keypoints of a frame, sorted into square buckets of the image, so that a search near a position touches
// only a few.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// Keypoint indices by bucket (counting sort; within a bucket, in the order of the keypoints).
class KeypointBuckets {
 public:
  // Without enough scratch there are no buckets, and nothing is visited.
  KeypointBuckets(const FixedVector<Keypoint>& keypoints, int width, int height, Arena& scratch);

  // Calls visit(index) for every keypoint in the buckets that the square of ±radius around (u, v) touches.
  template <typename Visit>
  void for_each_near(double u, double v, double radius, const Visit& visit) const {
    const int x0 = std::max(0, static_cast<int>(u - radius) / kSide_px);
    const int y0 = std::max(0, static_cast<int>(v - radius) / kSide_px);
    const int x1 = std::min(columns_ - 1, static_cast<int>(u + radius) / kSide_px);
    const int y1 = std::min(rows_ - 1, static_cast<int>(v + radius) / kSide_px);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const auto b = static_cast<std::size_t>(y * columns_ + x);
        for (std::size_t i = starts_[b]; i < starts_[b + 1]; ++i) visit(order_[i]);
      }
    }
  }

  // Takes the memory of a constructor's call.
  static constexpr void reserve(Arena& memory, std::size_t keypoints, int width, int height) {
    memory.take<std::uint16_t>("buckets", keypoints);
    memory.take<std::uint16_t>("buckets", count(width, height) + 1);
  }

 private:
  static constexpr int kSide_px = 32;
  static constexpr int along(int length) { return (length + kSide_px - 1) / kSide_px; }
  static constexpr std::size_t count(int width, int height) {
    return static_cast<std::size_t>(along(width)) * static_cast<std::size_t>(along(height));
  }
  std::size_t bucket(const Keypoint& k) const;

  int columns_ = 0, rows_ = 0;
  std::span<std::uint16_t> order_;
  std::span<std::uint16_t> starts_;
};

}  // namespace plvo
