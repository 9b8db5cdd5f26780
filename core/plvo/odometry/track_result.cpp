// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/track_result.hpp"

namespace plvo {

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::kInitialising: return "initialising";
    case TrackState::kTracking: return "tracking";
    case TrackState::kLost: return "lost";
    case TrackState::kPredicted: return "predicted";
  }
  return "unknown";
}

std::optional<ObservedRotation> observed_rotation(const TrackResult& result) {
  const bool starts = result.state == TrackState::kInitialising && result.status.ok();
  if ((result.state != TrackState::kTracking || result.repeated) && !starts) return std::nullopt;
  return ObservedRotation{result.stamp_ns, result.reference_stamp_ns, result.T_camera_reference.R,
                          result.motion_covariance.block<3, 3>(3, 3)};
}

bool make_sound(TrackResult& result) {
  for (const Se3* T : {&result.T_world_camera, &result.T_camera_reference})
    if (!T->is_finite() || !is_rotation(T->R)) return false;
  return make_bounded_covariance(result.pose_covariance) &&
         make_bounded_covariance(result.motion_covariance) && is_finite(result.mean_brightness) &&
         is_finite(result.disagreement);
}

}  // namespace plvo
