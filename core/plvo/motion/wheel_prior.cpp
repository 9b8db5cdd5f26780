// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/wheel_prior.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// ∫₀¹ exp(A u) du = Σ Aᵏ / (k + 1)!. For A = [ω]× it turns v into the translation of Exp((v, ω)), for
// A = −ad(ξ) it is the right Jacobian at ξ. With |ω| ≤ π the terms left out are below 1e-9 of the sum.
template <int Size>
Matrix<Size, Size> mean_exponential(const Matrix<Size, Size>& A) {
  constexpr int kTerms = 20;
  Matrix<Size, Size> term = Matrix<Size, Size>::Identity();
  Matrix<Size, Size> sum = term;
  for (int k = 1; k < kTerms; ++k) {
    term = Matrix<Size, Size>(term.lazyProduct(A)) / (k + 1);
    sum += term;
  }
  return sum;
}

Matrix6 twist_matrix(const Matrix3& diagonal, const Matrix3& corner) {
  Matrix6 J = Matrix6::Zero();
  J.block<3, 3>(0, 0) = diagonal;
  J.block<3, 3>(0, 3) = corner;
  J.block<3, 3>(3, 3) = diagonal;
  return J;
}

Status refuse_wheels(const char* why) { return Status(StatusCode::kInvalidArgument, "wheels: ").append(why); }

Status check_step(const WheelStep& step) {
  if (!(step.seconds > 0 && step.seconds <= 1e6)) return refuse_wheels("a step must be longer than 0 s");
  if (!step.twist.allFinite() || !step.covariance.allFinite())
    return refuse_wheels("twist and covariance must be finite");
  const double angle_squared = step.twist.tail<3>().squaredNorm() * step.seconds * step.seconds;
  if (!(angle_squared <= kPi * kPi))
    return refuse_wheels("a step must turn by at most pi; give shorter ones");
  return {};
}

}  // namespace

Status BaseMotion::add(const WheelStep& step, double error_s) {
  if (Status status = check_step(step); !status.ok()) return status;
  if (!(error_s >= 0 && error_s <= 1e6)) return refuse_wheels("error_s must lie between 0 and 1e6 s");
  const Vector3 way = step.seconds * step.twist.head<3>(), turn = step.seconds * step.twist.tail<3>();
  const Se3 T{rotation_exp(turn), mean_exponential<3>(skew(turn)) * way};
  // J_r maps an error of the twist to an error in the axes of the base after the step. T.R rotates
  // it into the axes before the step.
  const Matrix6 J_r = mean_exponential<6>(twist_matrix(-skew(turn), -skew(way)));
  const Matrix6 J = twist_matrix(T.R, Matrix3::Zero()).lazyProduct(J_r);
  const Matrix6 C_per_s2 = transform_covariance(J, step.covariance);
  const double lasts_s = step.seconds > error_s ? step.seconds : error_s;
  covariance_ = compose_covariance(T_before_now_, covariance_, T, step.seconds * lasts_s * C_per_s2);
  T_before_now_ = T_before_now_ * T;
  moved_ = true;
  return {};
}

Status BaseMotion::prior(const Se3& T_base_camera, MotionPrior& prior) const {
  prior = MotionPrior();
  if (!moved_) return refuse_wheels("there must be a step at least");
  if (!is_rotation(T_base_camera.R) || !T_base_camera.t.allFinite())
    return refuse_wheels("T_base_camera must be a rotation and a finite position");
  const Se3 T_camera_base = T_base_camera.inverse(), T_base_before = T_before_now_.inverse();
  const Se3 T_camera_before = T_camera_base * T_base_before;
  Se3 T_now_before = T_camera_before * T_base_camera;
  T_now_before.R = renormalise(T_now_before.R);
  const Matrix6 exact = Matrix6::Zero();
  Matrix6 C = inverse_covariance(T_before_now_, covariance_);
  C = compose_covariance(T_camera_base, exact, T_base_before, C);
  C = compose_covariance(T_camera_before, C, T_base_camera, exact);
  C = symmetric<6>(C);
  MotionPrior made;
  made.rotation = {T_now_before.R, C.block<3, 3>(3, 3)};
  made.translation = {T_now_before.t, C.block<3, 3>(0, 0)};
  Status status = made.validate();
  if (status.ok()) prior = made;
  return status;
}

Status wheel_prior(std::span<const WheelStep> steps, double error_s, const Se3& T_base_camera,
                   MotionPrior& prior) {
  prior = MotionPrior();
  BaseMotion motion;
  for (const WheelStep& step : steps)
    if (Status status = motion.add(step, error_s); !status.ok()) return status;
  return motion.prior(T_base_camera, prior);
}

}  // namespace plvo
