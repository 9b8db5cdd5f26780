// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/point_match.hpp"

#include <algorithm>

#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

constexpr std::uint16_t kNone = 0xffff;

// Best match of reference keypoint i. Returns kNone if no keypoint is near enough in position and descriptor,
// or if the second best is as good.
BestMatch find_best(const PointFeatures& reference, std::size_t i, const Prediction& prediction,
                    const PointFeatures& current, const KeypointBuckets& buckets,
                    const PointMatchConfig& config) {
  const Descriptor& descriptor = reference.descriptors[i];
  const std::uint8_t level = reference.keypoints[i].level;
  const double radius_squared = config.radius_px * config.radius_px;
  BestMatch best{kNone, 257};
  int second = 257;
  buckets.for_each_near(prediction.u, prediction.v, config.radius_px, [&](std::uint16_t j) {
    const Keypoint& candidate = current.keypoints[j];
    if (candidate.level != level) return;
    const double du = candidate.u - prediction.u;
    const double dv = candidate.v - prediction.v;
    if (du * du + dv * dv > radius_squared) return;
    const int distance = hamming_distance(descriptor, current.descriptors[j]);
    // For equal distances, takes the smaller index, so the order of the buckets does not matter.
    if (distance < best.distance || (distance == best.distance && j < best.index)) {
      second = best.distance;
      best = {j, static_cast<std::uint16_t>(distance)};
    } else if (distance < second) {
      second = distance;
    }
  });
  // An equally good second match rejects the match, even at distance 0, where every ratio test passes.
  if (best.distance > config.max_distance || best.distance >= second ||
      best.distance > config.max_ratio * second)
    best.index = kNone;
  return best;
}

}  // namespace

void match_points(const PointFeatures& reference, std::span<const Prediction> predictions,
                  const PointFeatures& current, int width, int height, const PointMatchConfig& config,
                  Arena& scratch, FixedVector<Match>& out) {
  const ScratchScope scope(scratch);
  out.clear();
  const KeypointBuckets buckets(current.keypoints, width, height, scratch);
  const std::span<BestMatch> forward = scratch.take<BestMatch>("point match", reference.keypoints.size());
  const std::span<BestMatch> backward = scratch.take<BestMatch>("point match", current.keypoints.size());
  if (forward.size() < reference.keypoints.size() || backward.size() < current.keypoints.size()) return;

  // Mutual matching: a current keypoint is assigned to the nearest of the reference keypoints that chose it;
  // among equal ones, to the first.
  std::fill(backward.begin(), backward.end(), BestMatch{kNone, 257});
  for (std::size_t i = 0; i < forward.size(); ++i) {
    forward[i] = {kNone, 257};
    if (!predictions[i].visible) continue;
    forward[i] = find_best(reference, i, predictions[i], current, buckets, config);
    if (forward[i].index == kNone) continue;
    BestMatch& rival = backward[forward[i].index];
    if (forward[i].distance < rival.distance) rival = {static_cast<std::uint16_t>(i), forward[i].distance};
  }
  for (std::size_t i = 0; i < forward.size(); ++i) {
    if (forward[i].index != kNone && backward[forward[i].index].index == i)
      out.push_back({static_cast<std::uint16_t>(i), forward[i].index});
  }
}

}  // namespace plvo
