// SPDX-License-Identifier: Apache-2.0
// The prediction of a frame's motion before its features are associated, and the pose of a frame without an
// observed motion.
#pragma once

#include "plvo/odometry/gravity_filter.hpp"
#include "plvo/odometry/tracking/current_frame.hpp"
#include "plvo/odometry/window/window.hpp"

namespace plvo {

// Time from the colour exposure to the depth exposure of a frame with these stamps, as in exposure.hpp.
double depth_after_colour_s(const CameraModel& camera, std::int64_t depth_stamp_ns, std::int64_t stamp_ns);

// The motion since each of the window's references, and that of the camera during the exposure. sensed: the
// motion since the last good frame by other sensors. The prediction points to `references`.
PredictedMotion predict(const Window& window, const CameraModel& camera, std::int64_t stamp_ns,
                        const PropagatedPrior& sensed, double depth_after_colour_s,
                        std::span<Reference, kMaxReferences> references);
// The motion since the lost frame, which is the frame before this one and the only reference.
PredictedMotion predict_from_lost(const Window& window, const CurrentFrame& frame, Reference& reference);

// The last good pose, with the uncertainty of the unobserved motion since then: the process noise, and as one
// standard deviation the motion of a camera that kept its velocity. Tracking is mostly lost in fast motion.
PoseWithCovariance unobserved_pose(const Window& window, const ReferenceConfig& config,
                                   std::int64_t stamp_ns);

// A pose after a motion that the images did not observe.
struct SensedPose {
  Se3 T_camera_reference;
  Matrix6 motion_covariance;
  PoseWithCovariance pose;
};
// The pose after this motion since the last good frame, and the motion since the keyframe or, without one or
// with given_up, since the last good frame. The correction by gravity applies to this frame only: the kept
// frames were observed, this one was not.
SensedPose pose_after(const Window& window, const GravityFilter& gravity, const Se3& T_current_last,
                      const Matrix6& covariance, const MotionPrior& prior, bool given_up = false);
// The pose by the priors alone.
inline SensedPose sensed_pose(const Window& window, const GravityFilter& gravity, const CurrentFrame& frame,
                              bool given_up = false) {
  const PropagatedPrior& sensed = frame.predicted.sensed;
  return pose_after(window, gravity, sensed.T_current_last(), sensed.covariance(), frame.prior, given_up);
}

}  // namespace plvo
