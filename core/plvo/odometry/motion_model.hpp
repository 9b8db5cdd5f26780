// SPDX-License-Identifier: Apache-2.0
// The motion model of the camera: constant velocity, and process noise where the motion is not observed. The
// state of a frame is its pose and this velocity. It predicts the next motion, completes the priors, gives
// each exposure its velocity, and says how fast a pose becomes uncertain.
#pragma once

#include <cstdint>

#include "plvo/math/se3.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo {

// The velocity (v, ω) per second of the scene in the camera's axes (exposure.hpp), a mean over measured_ns.
struct Velocity {
  Vector6 value = Vector6::Zero();
  std::int64_t measured_ns = 0;  // 0: the velocity is not known

  bool known() const { return measured_ns > 0; }
  // Whether the search for the next motion starts from this velocity, elapsed_ns after it was measured. Over
  // more than a multiple of its own interval, a prediction is worse than no prediction.
  bool predicts(std::int64_t elapsed_ns) const {
    constexpr int kLongestPrediction = 3;
    return static_cast<double>(elapsed_ns) < kLongestPrediction * static_cast<double>(measured_ns);
  }
  // Whether this velocity completes the priors of other sensors, elapsed_ns after it was measured: as long as
  // it predicts, and for 300 ms at least. Later, the camera is taken to stand still. Such a motion is not
  // corrected; the process noise covers its error.
  bool continues(std::int64_t elapsed_ns) const {
    constexpr std::int64_t kLeast_ns = 300'000'000;
    return known() && (predicts(elapsed_ns) || elapsed_ns <= kLeast_ns);
  }
};

// Mean velocity of a motion that took this long.
Vector6 mean_velocity(const Se3& T_now_before, double seconds);
// The motion at a constant velocity: T_now_before.
Se3 motion_at(const Vector6& velocity, double seconds);

// Velocity during the exposure of the current frame. recent: mean since the last good frame. before: that of
// the last good frame, over the interval before it. Under a constant acceleration, the velocity at the end of
// the interval is recent + (recent − before) / 2. Half of this correction is used: all of it would add too
// much of its noise. The mean over a long interval serves as well: a camera that moves smoothly still has
// this velocity, and of one that sways, the mean is small.
Vector6 velocity_at_exposure(const Vector6& recent, const Velocity& before);

// Variance of an unobserved motion from from_s to to_s after the last observation, with this SD per second.
// The error of an assumed rate hardly changes from one frame to the next, so its standard deviation grows
// with time, not its variance.
double process_noise_variance(double per_second, double from_s, double to_s);
// Adds it to the covariance of a pose that was observed `seconds` ago. No rotation becomes more uncertain
// than the bound of covariance.hpp.
void add_process_noise(const ReferenceConfig& config, double seconds, Matrix6& covariance);

}  // namespace plvo
