// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/motion_model.hpp"

#include <algorithm>

#include "plvo/math/covariance.hpp"

namespace plvo {

Vector6 mean_velocity(const Se3& T_now_before, double seconds) {
  return boxminus(T_now_before, Se3{}) / seconds;
}

Se3 motion_at(const Vector6& velocity, double seconds) { return boxplus(Se3{}, seconds * velocity); }

// Intervals of different lengths have the same weights. The random walk alone would trust the shorter
// interval more, but its mean has more noise of the measurement.
Vector6 velocity_at_exposure(const Velocity& recent, const Velocity& before) {
  if (!recent.known() || !before.known()) return recent.value;
  return recent.value + 0.25 * (recent.value - before.value);
}

Vector6 velocity_between(const Velocity& before, const Velocity& after) {
  if (!before.known()) return after.value;
  if (!after.known()) return before.value;
  return 0.5 * (before.value + after.value);
}

double process_noise_variance(double per_second, double from_s, double to_s) {
  const double from = per_second * from_s;
  const double to = per_second * to_s;
  return to * to - from * from;
}

void add_process_noise(const ReferenceConfig& config, double seconds, Matrix6& covariance) {
  const double position = process_noise_variance(config.process_noise_m_per_s, 0, seconds);
  const double rotation = process_noise_variance(config.process_noise_rad_per_s, 0, seconds);
  for (int i = 0; i < 3; ++i) {
    covariance(i, i) += position;
    double& turned = covariance(3 + i, 3 + i);
    turned += std::clamp(kMostRotationVariance - turned, 0.0, rotation);
  }
}

}  // namespace plvo
