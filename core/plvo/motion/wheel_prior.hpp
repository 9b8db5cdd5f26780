// SPDX-License-Identifier: Apache-2.0
// Turns the twist of a robot's base, as wheel odometry measures it, into the prior of a frame.
//
// A twist ξ = (v, ω) holds for s seconds: T_before_now = Exp(s ξ), the exponential of SE(3). Several steps
// are composed: T = T_1 … T_n. An error e of a twist, with covariance Q, moves the end of its step by
// J_r(s ξ) s e in the axes of the base there, where J_r is the right Jacobian of SE(3). A later step carries
// an error along by the adjoint of its inverse:
//   C ← Ad(T_i⁻¹) C Ad(T_i⁻¹)ᵀ + s max(s, error_s) J_r Q J_rᵀ.
// The camera sits at T_base_camera: T_now_before = T_base_camera⁻¹ T⁻¹ T_base_camera, and its error is that
// of the base, carried by Ad(T_base_camera⁻¹). MotionPrior wants the errors of rotation and position apart:
// (v, ω) = (ρ − [t_now_before]× φ, φ) for an error Exp((ρ, φ)) on the left. The prior has no correlation of
// the two; it is left out.
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
  // error_s: for how long an error of the twist lasts (slip, a wheel that is larger than stated). After a
  // longer time t the variance is Q error_s t. Errors of different steps are independent; an error that
  // outlasts a step therefore counts as larger in each of them.
  //
  // Returns kInvalidArgument, and adds nothing, for numbers that are not finite, and a step that is not
  // longer than 0 s or turns by more than π.
  Status add(const WheelStep& step, double error_s);

  // Returns kInvalidArgument, and an empty prior, before the first step and for a T_base_camera that is not a
  // rotation; and as MotionPrior::validate(), which refuses a covariance that is not positive definite.
  Status prior(const Se3& T_base_camera, MotionPrior& prior) const;

 private:
  bool moved_ = false;
  Se3 T_before_now_;
  Matrix6 covariance_ = Matrix6::Zero();  // of an error Exp((ρ, φ)) on the right of T_before_now_
};

// Both for all steps of a frame.
Status wheel_prior(std::span<const WheelStep> steps, double error_s, const Se3& T_base_camera,
                   MotionPrior& prior);

}  // namespace plvo
