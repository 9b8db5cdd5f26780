// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/propagated_prior.hpp"

#include "plvo/math/covariance.hpp"
#include "plvo/odometry/motion_model.hpp"

namespace plvo {
namespace {

Matrix3 covariance_of_unobserved(double per_second, double before_s, double now_s) {
  constexpr double kLeast = 1e-12;
  const double variance = process_noise_variance(per_second, before_s, now_s);
  return Matrix3::Identity() * (variance > kLeast ? variance : kLeast);
}

}  // namespace

void PropagatedPrior::extend(const MotionPrior& prior, const Vector6& coasted, double seconds,
                             const ReferenceConfig& config) {
  whole_ = whole_ && prior.tells_motion();
  if (!whole_) return;
  const double before_s = seconds_;
  seconds_ += seconds;
  ++frames_;
  Se3 T_now_before;
  Matrix6 covariance = Matrix6::Zero();
  if (prior.rotation) {
    T_now_before.R = renormalise(prior.rotation->R_now_before);
    covariance.block<3, 3>(3, 3) = prior.rotation->covariance;
  } else {
    T_now_before.R = rotation_exp(coasted.tail<3>());
    covariance.block<3, 3>(3, 3) =
        covariance_of_unobserved(config.process_noise_rad_per_s, before_s, seconds_);
  }
  if (prior.translation) {
    T_now_before.t = prior.translation->t_now_before;
    covariance.block<3, 3>(0, 0) = prior.translation->covariance;
  } else {
    // The translation goes straight on, whatever the camera's rotation.
    T_now_before.t = T_now_before.R * (T_current_last_.R * coasted.head<3>());
    covariance.block<3, 3>(0, 0) = covariance_of_unobserved(config.process_noise_m_per_s, before_s, seconds_);
  }
  covariance_ = compose_covariance(T_now_before, covariance, T_current_last_, covariance_);
  T_current_last_ = T_now_before * T_current_last_;
  T_current_last_.R = renormalise(T_current_last_.R);
  whole_ =
      !may_be_anywhere(covariance_) && make_bounded_covariance(covariance_) && T_current_last_.is_finite();
}

}  // namespace plvo
