// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/gravity_filter.hpp"

#include <algorithm>

#include "plvo/math/covariance.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr double kJolt = 13.816;  // 99.9 % quantile of χ²(2)
// No accelerometer measures the direction of gravity to better than a microradian. A smaller variance would
// cancel that of a pose with a very uncertain rotation (kMostRotationVariance) beyond the digits of a double.
constexpr double kLeastReadingVariance = 1e-12;

Matrix3 turned(const Matrix3& J, const Matrix3& C) {
  return symmetric<3>(J.lazyProduct(C).eval().lazyProduct(J.transpose()));
}

}  // namespace

// g = R (z − β − noise), R being off by ω: ε = −[g]× ω − R (β + noise).
void GravityFilter::start(const Vector3& z, const GravityPrior& reading, const Matrix<6, 3>& from_omega,
                          PoseWithCovariance& from, PoseWithCovariance& current) {
  const Matrix3& R = current.T_world_camera.R;
  known_ = true;
  down_ = R * z;
  const Matrix3 G = skew(down_);
  from.covariance_with_gravity.setZero();
  current.covariance_with_gravity.setZero();
  from.covariance_with_gravity.block<6, 3>(0, 0) = from_omega.lazyProduct(G);
  current.covariance_with_gravity.block<6, 3>(0, 0) = current.covariance.block<6, 3>(0, 3).lazyProduct(G);
  const Matrix3 offset = Matrix3::Identity() * (reading.offset_sigma * reading.offset_sigma);
  covariance_.block<3, 3>(0, 0) =
      turned(G, current.covariance.block<3, 3>(3, 3)) + turned(R, reading.covariance) + offset;
  covariance_.block<3, 3>(0, 3) = -R.lazyProduct(offset);
  covariance_.block<3, 3>(3, 0) = -offset.lazyProduct(R.transpose());
  covariance_.block<3, 3>(3, 3) = offset;
}

// z = R_cw y + β + noise, with y known: the pose has the error ω = [y]× R (β + noise), and none about y.
void GravityFilter::level(const GravityPrior& reading, PoseWithCovariance& pose) {
  const Vector3 y(0, 1, 0);
  Vector3 z = reading.down / sqrt(reading.down.squaredNorm());
  // A camera that hangs upside down is rolled by half a turn, which keeps its direction of view.
  const bool hangs = z.y() < 0;
  Matrix3 roll = Matrix3::Identity();
  if (hangs) roll(0, 0) = roll(1, 1) = -1;
  z = roll * z;
  // The smallest rotation from z to y; V = [z × y]×.
  const Matrix3 V = y * z.transpose() - z * y.transpose();
  const Matrix3 R = renormalise(
      (Matrix3::Identity() + V + Matrix3(V.lazyProduct(V)) / (1 + z.y())).lazyProduct(roll).eval());
  const Matrix3 Y = skew(y);
  const Matrix3 offset = Matrix3::Identity() * (reading.offset_sigma * reading.offset_sigma);
  pose = PoseWithCovariance();
  pose.T_world_camera.R = R;
  pose.covariance.block<3, 3>(3, 3) = turned(Y, turned(R, reading.covariance + offset));
  pose.covariance_with_gravity.block<3, 3>(3, 3) = Y.lazyProduct(R).eval().lazyProduct(offset);
  *this = GravityFilter();
  known_ = true;
  down_ = y;
  covariance_.block<3, 3>(3, 3) = offset;
}

void GravityFilter::read(const GravityPrior& reading, PoseWithCovariance& from, PoseWithCovariance& current) {
  const Vector3 z = reading.down / sqrt(reading.down.squaredNorm());
  // Covariances of the errors of `from` and `current` with the orientation error of `current`.
  const Matrix<6, 3> from_omega =
      from.covariance.lazyProduct(derivative_of_advance(from, current).transpose()).eval().block<6, 3>(0, 3);
  const Matrix<6, 3> current_omega = current.covariance.block<6, 3>(0, 3);
  if (!known_) return start(z, reading, from_omega, from, current);

  const Matrix3 R_camera_world = current.T_world_camera.R.transpose();
  const Vector3 expected = R_camera_world * down_;
  const Matrix<3, 2> U = frame_along(expected).block<3, 2>(0, 0);
  const Matrix<2, 3> J_omega = U.transpose().lazyProduct(R_camera_world).eval().lazyProduct(skew(down_));
  Matrix<2, 6> J_gravity;
  J_gravity.block<2, 3>(0, 0) = U.transpose().lazyProduct(R_camera_world);
  J_gravity.block<2, 3>(0, 3) = U.transpose();
  // Covariance of an error with the residual, from those with the errors of the orientation and of gravity.
  const auto with_residual = [&](const Matrix<6, 3>& omega, const Matrix6& gravity) -> Matrix<6, 2> {
    return omega.lazyProduct(J_omega.transpose()) + gravity.lazyProduct(J_gravity.transpose());
  };
  const Matrix<6, 2> P_from = with_residual(from_omega, from.covariance_with_gravity);
  const Matrix<6, 2> P_current = with_residual(current_omega, current.covariance_with_gravity);
  const Matrix<6, 3> gravity_omega = current.covariance_with_gravity.block<3, 6>(3, 0).transpose();
  const Matrix<6, 2> P_gravity = with_residual(gravity_omega, covariance_);
  Matrix2 noise = U.transpose().lazyProduct(reading.covariance).eval().lazyProduct(U);
  for (int i = 0; i < 2; ++i) noise(i, i) = std::max(noise(i, i), kLeastReadingVariance);
  const Matrix2 S = symmetric<2>(J_omega.lazyProduct(P_current.block<3, 2>(3, 0)) +
                                 J_gravity.lazyProduct(P_gravity) + noise);
  const double determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(0, 1);
  if (!(determinant > 0)) return;
  Matrix2 S_inverse;
  S_inverse << S(1, 1), -S(0, 1), -S(0, 1), S(0, 0);
  S_inverse /= determinant;
  const Vector2 residual = U.transpose() * (z - expected - offset_);
  const Vector2 weighted = S_inverse * residual;
  if (!(residual.dot(weighted) <= kJolt) || expected.dot(z) < 0) return;

  const Matrix<2, 6> gain_gravity = S_inverse.lazyProduct(P_gravity.transpose());
  // What a shift changes in the residual.
  const Matrix<2, kLandmarkKinds> seen =
      S_inverse.lazyProduct(J_omega.lazyProduct(current.shifts.bottomRows<3>()));
  const auto correct = [&](PoseWithCovariance& pose, const Matrix<6, 2>& P) {
    pose.T_world_camera = boxplus(pose.T_world_camera, P.lazyProduct(weighted));
    pose.T_world_camera.R = renormalise(pose.T_world_camera.R);
    const Matrix<2, 6> gain = S_inverse.lazyProduct(P.transpose());
    pose.covariance = symmetric<6>(pose.covariance - P.lazyProduct(gain));
    pose.shifts -= P.lazyProduct(seen);
    pose.covariance_with_gravity -= P.lazyProduct(gain_gravity);
  };
  correct(from, P_from);
  correct(current, P_current);
  const Vector6 correction = P_gravity.lazyProduct(weighted);
  down_ += correction.head<3>();
  down_ /= sqrt(down_.squaredNorm());
  offset_ += correction.tail<3>();
  covariance_ = symmetric<6>(covariance_ - P_gravity.lazyProduct(gain_gravity));
  if (!make_covariance(covariance_)) forget();
}

}  // namespace plvo
