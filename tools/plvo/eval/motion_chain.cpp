// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/motion_chain.hpp"

#include <algorithm>

namespace plvo::eval {

// State of the traversal from a frame towards its ancestors.
struct MotionChain::Climb {
  std::size_t at = 0;
  Se3 T_start_at;
  Matrix6 covariance = Matrix6::Zero();
};

MotionChain::MotionChain(const std::vector<UncertainMotion>& motions) : motions_(motions) {
  for (const UncertainMotion& motion : motions) {
    stamps_ns_.push_back(motion.stamp_ns);
    stamps_ns_.push_back(motion.reference_stamp_ns);
  }
  std::sort(stamps_ns_.begin(), stamps_ns_.end());
  stamps_ns_.erase(std::unique(stamps_ns_.begin(), stamps_ns_.end()), stamps_ns_.end());
  motion_of_.assign(stamps_ns_.size(), -1);
  parent_.assign(stamps_ns_.size(), 0);
  const auto index = [this](std::int64_t stamp) {
    return static_cast<std::size_t>(std::lower_bound(stamps_ns_.begin(), stamps_ns_.end(), stamp) -
                                    stamps_ns_.begin());
  };
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::size_t frame = index(motions[i].stamp_ns);
    if (motion_of_[frame] >= 0 || motions[i].reference_stamp_ns >= motions[i].stamp_ns) continue;
    motion_of_[frame] = static_cast<std::ptrdiff_t>(i);
    parent_[frame] = index(motions[i].reference_stamp_ns);
  }
}

bool MotionChain::step(Climb& climb) const {
  const std::ptrdiff_t motion = motion_of_[climb.at];
  if (motion < 0) return false;
  const UncertainMotion& m = motions_[static_cast<std::size_t>(motion)];
  climb.covariance =
      compose_covariance(climb.T_start_at, climb.covariance, m.T_camera_reference, m.covariance);
  climb.T_start_at = climb.T_start_at * m.T_camera_reference;
  climb.at = parent_[climb.at];
  return true;
}

bool MotionChain::between(std::size_t from, std::size_t to, Se3& T_to_from, Matrix6& covariance) const {
  Climb a{from, {}, Matrix6::Zero()};
  Climb b{to, {}, Matrix6::Zero()};
  // Ancestors are older: step from the newer of the two until they meet.
  while (a.at != b.at) {
    if (!step(a.at > b.at ? a : b)) return false;
  }
  covariance = compose_covariance(b.T_start_at, b.covariance, a.T_start_at.inverse(),
                                  inverse_covariance(a.T_start_at, a.covariance));
  T_to_from = b.T_start_at * a.T_start_at.inverse();
  return true;
}

}  // namespace plvo::eval
