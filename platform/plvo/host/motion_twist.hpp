// SPDX-License-Identifier: Apache-2.0
// The velocity of a robot's base, from the results of consecutive frames.
#pragma once

#include <cstdint>
#include <optional>

#include "plvo/odometry/track_result.hpp"

namespace plvo {

// Mean velocity since the frame before: m/s, then rad/s, in the axes of the base now. The covariance is of
// the same order.
struct Twist {
  Vector6 velocity = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
};

class MotionTwist {
 public:
  // base: a result with a pose, of the base (result_of_base). Returns nothing if the motion since the frame
  // before was not measured: for a first frame, for a restart from a lost frame, and for a corrected pose.
  std::optional<Twist> of(const TrackResult& base);
  // The pose of the last frame has been set: the motion to the next one is measured from it.
  void move_to(const Se3& T_odom_base) { last_.T_world_camera = T_odom_base; }
  void forget() { has_last_ = false; }

 private:
  TrackResult last_;
  bool has_last_ = false;
};

}  // namespace plvo
