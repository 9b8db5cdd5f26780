// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/motion_twist.hpp"

namespace plvo {
namespace {

bool continues_the_last_frame(const TrackResult& base) {
  return base.state != TrackState::kInitialising && !base.restarted && !base.relocalised;
}

// Covariance of T_now_last. If the last frame is the reference, it is that of the motion. Otherwise both
// frames were measured from references that are taken as exact; their errors are taken as independent, which
// overestimates the sum if they share a reference.
Matrix6 covariance_since(const TrackResult& last, const TrackResult& now, const Se3& T_now_last) {
  if (now.reference_stamp_ns == last.stamp_ns) return now.motion_covariance;
  const Se3& T_last_reference = last.T_camera_reference;
  const Matrix6 of_inverse = inverse_covariance(T_last_reference, last.motion_covariance);
  return compose_covariance(T_now_last * T_last_reference, now.motion_covariance, T_last_reference.inverse(),
                            of_inverse);
}

}  // namespace

std::optional<Twist> MotionTwist::of(const TrackResult& base) {
  std::optional<Twist> twist;
  if (has_last_ && base.stamp_ns > last_.stamp_ns && continues_the_last_frame(base)) {
    const double seconds = static_cast<double>(base.stamp_ns - last_.stamp_ns) * 1e-9;
    const Se3 T_now_last = base.T_world_camera.inverse() * last_.T_world_camera;
    twist.emplace();
    twist->velocity << -T_now_last.t / seconds, -rotation_log(T_now_last.R) / seconds;
    twist->covariance = covariance_since(last_, base, T_now_last) / (seconds * seconds);
  }
  last_ = base;
  has_last_ = true;
  return twist;
}

}  // namespace plvo
