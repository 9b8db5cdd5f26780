// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/keypoint_buckets.hpp"

namespace plvo {

KeypointBuckets::KeypointBuckets(const FixedVector<Keypoint>& keypoints, int width, int height,
                                 Arena& scratch) {
  order_ = scratch.take<std::uint16_t>("buckets", keypoints.size());
  starts_ = scratch.take<std::uint16_t>("buckets", count(width, height) + 1);
  if (starts_.empty() || order_.size() < keypoints.size()) return;
  columns_ = along(width);
  rows_ = along(height);
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

std::size_t KeypointBuckets::bucket(const Keypoint& k) const {
  const int x = std::clamp(static_cast<int>(k.u) / kSide_px, 0, columns_ - 1);
  const int y = std::clamp(static_cast<int>(k.v) / kSide_px, 0, rows_ - 1);
  return static_cast<std::size_t>(y * columns_ + x);
}

}  // namespace plvo
