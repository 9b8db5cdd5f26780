// SPDX-License-Identifier: Apache-2.0
// The motion model of the camera. Its velocity is a random walk, so the last velocity is the best
// guess for the next. Where the motion is not observed, there is process noise. The state of a
// frame is its pose and its velocity. It predicts the next motion, completes the priors, gives each
// exposure its velocity, and says how fast a pose becomes uncertain.
#pragma once

#include <algorithm>
#include <cstdint>

#include "plvo/math/se3.hpp"
#include "plvo/odometry/config.hpp"

namespace plvo {

// The velocity (v, ω) per second of the scene in the camera's axes (exposure.hpp), a mean over measured_ns.
struct Velocity {
  Vector6 value = Vector6::Zero();
  std::int64_t measured_ns = 0;         // 0: the velocity is not known
  static constexpr int kIntervals = 3;  // for which it says something

  bool known() const { return measured_ns > 0; }
  bool is_out_of_date(std::int64_t elapsed_ns) const {
    return known() && static_cast<double>(elapsed_ns) > kIntervals * static_cast<double>(measured_ns);
  }
  // Seconds for which the camera is assumed to keep this velocity, of the elapsed_ns since the
  // measurement. It is assumed to keep it for three times the interval over which it was measured,
  // but for 300 ms at least, and then to stand still: the longer the gap, the less the old velocity
  // says. The process noise covers the error.
  double moving_s(std::int64_t elapsed_ns) const {
    constexpr double kLeast_s = 0.3;
    if (!known()) return 0;
    const double longest_s = std::max(kIntervals * 1e-9 * static_cast<double>(measured_ns), kLeast_s);
    return std::min(1e-9 * static_cast<double>(elapsed_ns), longest_s);
  }
};

// Mean velocity of a motion that took this long.
Vector6 mean_velocity(const Se3& T_now_before, double seconds);
// The motion at a constant velocity: T_now_before.
Se3 motion_at(const Vector6& velocity, double seconds);

// The motion of a camera with this velocity, elapsed_ns after it was measured: T_now_then.
inline Se3 coasted_motion(const Velocity& velocity, std::int64_t elapsed_ns) {
  return motion_at(velocity.value, velocity.moving_s(elapsed_ns));
}

// Velocity at the end of an interval, during the exposure of the current frame. recent: mean over the
// interval since the last good frame. before: mean over the interval before that. For a random walk and
// intervals of equal length, the best linear estimate is recent + (recent − before) / 4. (Under a constant
// acceleration it would be half of the difference.)
Vector6 velocity_at_exposure(const Velocity& recent, const Velocity& before);
// Velocity between two intervals: for a random walk, the best linear estimate is the mean of both.
Vector6 velocity_between(const Velocity& before, const Velocity& after);

// Variance of an unobserved motion from from_s to to_s after the last observation, with this SD per second.
// The error of an assumed rate hardly changes from one frame to the next, so its standard deviation grows
// with time, not its variance.
double process_noise_variance(double per_second, double from_s, double to_s);
// Adds it to the covariance of a pose that was observed `seconds` ago. No rotation becomes more uncertain
// than the bound of covariance.hpp.
void add_process_noise(const ReferenceConfig& config, double seconds, Matrix6& covariance);

}  // namespace plvo
