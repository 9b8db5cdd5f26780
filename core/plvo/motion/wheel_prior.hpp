// SPDX-License-Identifier: Apache-2.0
// Turns the twist of a robot's base, as wheel odometry measures it, into the prior of a frame.
//
// A twist ξ = (v, ω) that holds for s seconds moves the base by Exp(s ξ), the exponential of SE(3). The
// motion over several steps is the product of theirs: T_before_now = T_1 … T_n. An error e of a twist, with
// covariance Q, turns the motion T of its step into T Exp(s J_r(s ξ) e), where J_r is the right Jacobian of
// SE(3). As a small motion of se3.hpp that is s J e with J = diag(R, R) J_r(s ξ), where R is the rotation of
// T. The step's covariance is therefore
//   C = s max(s, error_s) J Q Jᵀ,
// and compose_covariance joins the steps.
//
// The pose of the camera on the robot, T_base_camera, is taken as exact: T_now_before = T_base_camera⁻¹
// T_before_now⁻¹ T_base_camera. inverse_covariance and compose_covariance transform the covariance.
// MotionPrior has no correlation of rotation and position: it is left out.
#pragma once

#include <span>

#include "plvo/motion/motion_prior.hpp"

namespace plvo {

// The axes are those of the base: x forward, y left, z up, if T_base_camera says so. Wheels measure neither
// vz nor ωx nor ωy: these are 0, and their variances say how much the robot bounces and tilts.
struct WheelStep {
  double seconds = 0;
  Vector6 twist = Vector6::Zero();           // (v, ω): m/s, rad/s
  Matrix6 covariance = Matrix6::Identity();  // of the twist
};

// The motion of the base since the frame before, step by step, oldest first.
class BaseMotion {
 public:
  // error_s: the duration for which an error of the twist lasts (slip, a wheel that is larger than stated).
  // After a longer time t the variance is Q error_s t. Errors of different steps are taken as independent, so
  // an error that outlasts a step has a larger variance in each step.
  //
  // Returns kInvalidArgument, and adds nothing, for numbers that are not finite, and a step that is not
  // longer than 0 s or turns by more than π.
  Status add(const WheelStep& step, double error_s);

  // Returns kInvalidArgument and an empty prior before the first step, and if T_base_camera is not
  // a finite rigid motion. The same holds if MotionPrior::validate() refuses the prior, for example
  // because its covariance is not positive definite.
  Status prior(const Se3& T_base_camera, MotionPrior& prior) const;

 private:
  bool moved_ = false;
  Se3 T_before_now_;
  Matrix6 covariance_ = Matrix6::Zero();  // of T_before_now_, as in se3.hpp
};

// The prior of these steps: BaseMotion::add for each, then BaseMotion::prior.
Status wheel_prior(std::span<const WheelStep> steps, double error_s, const Se3& T_base_camera,
                   MotionPrior& prior);

}  // namespace plvo
