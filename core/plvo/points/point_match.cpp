// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/point_match.hpp"

#include <algorithm>

#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

constexpr std::uint16_t kNone = 0xffff;

// Keypoint indices by bucket (counting sort; within a bucket, in the order of the keypoints).
class Buckets {
 public:
  Buckets(const FixedVector<Keypoint>& keypoints, int width, int height, Arena& scratch)
      : columns_((width + kBucketPx - 1) / kBucketPx), rows_((height + kBucketPx - 1) / kBucketPx) {
    order_ = scratch.take<std::uint16_t>("point match", keypoints.size());
    starts_ = scratch.take<std::uint16_t>("point match", point_match_buckets(width, height) + 1);
    if (starts_.empty() || order_.size() < keypoints.size()) return;
    std::fill(starts_.begin(), starts_.end(), std::uint16_t{0});
    for (const Keypoint& k : keypoints) ++starts_[bucket(k) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i)
      starts_[i] = static_cast<std::uint16_t>(starts_[i] + starts_[i - 1]);
    // Fills from the back, which moves every start to its final value.
    for (std::size_t i = keypoints.size(); i-- > 0;)
      order_[--starts_[bucket(keypoints[i]) + 1]] = static_cast<std::uint16_t>(i);
    for (std::size_t b = 0; b + 1 < starts_.size(); ++b) starts_[b] = starts_[b + 1];
    starts_[starts_.size() - 1] = static_cast<std::uint16_t>(keypoints.size());
  }

  // Calls visit(index) for every keypoint in the buckets that the square of ±radius around (u, v) touches.
  template <typename Visit>
  void for_each_near(double u, double v, double radius, Visit visit) const {
    const int x0 = std::max(0, static_cast<int>(u - radius) / kBucketPx);
    const int y0 = std::max(0, static_cast<int>(v - radius) / kBucketPx);
    const int x1 = std::min(columns_ - 1, static_cast<int>(u + radius) / kBucketPx);
    const int y1 = std::min(rows_ - 1, static_cast<int>(v + radius) / kBucketPx);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const auto b = static_cast<std::size_t>(y * columns_ + x);
        for (std::size_t i = starts_[b]; i < starts_[b + 1]; ++i) visit(order_[i]);
      }
    }
  }

 private:
  std::size_t bucket(const Keypoint& k) const {
    const int x = std::clamp(static_cast<int>(k.u) / kBucketPx, 0, columns_ - 1);
    const int y = std::clamp(static_cast<int>(k.v) / kBucketPx, 0, rows_ - 1);
    return static_cast<std::size_t>(y * columns_ + x);
  }

  int columns_, rows_;
  std::span<std::uint16_t> order_;
  std::span<std::uint16_t> starts_;
};

// Best match of reference keypoint i. Returns kNone if no keypoint is near enough in position and descriptor,
// or if the second best is as good.
BestMatch find_best(const PointFeatures& reference, std::size_t i, const Prediction& prediction,
                    const PointFeatures& current, const Buckets& buckets, const PointMatchConfig& config) {
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
  const Buckets buckets(current.keypoints, width, height, scratch);
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
