// SPDX-License-Identifier: Apache-2.0
// Putative point matches: nearest neighbours in Hamming distance near the predicted position of the reference
// keypoint. A match must be mutual and clearly better than the second best.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/match.hpp"
#include "plvo/points/keypoint.hpp"
#include "plvo/points/keypoint_buckets.hpp"

namespace plvo {

// The odometry changes only the radius.
struct PointMatchConfig {
  double radius_px = 30;  // level-0 pixels around the prediction; if the search fails, a second one is wider
  int max_distance = 64;  // Hamming, of 256 bits
  double max_ratio = 0.85;  // best distance / second best distance
};

// Predicted position of a reference keypoint. It is not visible if outside the image or behind the camera.
struct Prediction {
  float u = 0, v = 0;  // level-0 pixels
  bool visible = false;
};

struct BestMatch {
  std::uint16_t index;
  std::uint16_t distance;
};

// Reserves the scratch of match_points for this number of keypoints per frame and this image size.
constexpr void reserve_point_match(Arena& memory, int keypoints, int width, int height) {
  const ScratchScope scope(memory);
  const auto n = static_cast<std::size_t>(keypoints);
  KeypointBuckets::reserve(memory, n, width, height);
  memory.take<BestMatch>("point match", n);
  memory.take<BestMatch>("point match", n);
}

// predictions: one per keypoint of the reference. Only keypoints of the same pyramid level are compared.
// `out` follows the order of the reference's keypoints.
void match_points(const PointFeatures& reference, std::span<const Prediction> predictions,
                  const PointFeatures& current, int width, int height, const PointMatchConfig& config,
                  Arena& scratch, FixedVector<Match>& out);

}  // namespace plvo
