// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/disagreement.hpp"

#include <algorithm>

#include "plvo/math/mahalanobis.hpp"

namespace plvo {
namespace {

constexpr double kMemory_s = 0.5;  // τ
constexpr double kDegreesOfFreedom = 6;
constexpr double kMostInflation = 1000;

}  // namespace

[[gnu::noinline]] void Disagreement::note(const PoseWithCovariance& last, const PoseWithCovariance& pose,
                                          const Se3& T_current_from, const Matrix6& C, double elapsed_s) {
  const Matrix6 A = derivative_of_advance(last, pose);
  const Matrix6 to_camera = rotation_of_both(pose.T_world_camera.R.transpose());
  const double kept = kMemory_s / (kMemory_s + elapsed_s);
  const Matrix6 T =
      kept * to_camera.lazyProduct(A).eval().lazyProduct(rotation_of_both(last.T_world_camera.R));
  const OfEachKind added = pose.shifts - A.lazyProduct(last.shifts);
  shifts_ = T.lazyProduct(shifts_).eval() + to_camera.lazyProduct(added);
  Matrix6 B = Matrix6::Identity();
  B.block<3, 3>(0, 3) = skew(T_current_from.t);
  noise_ = transform_covariance(T, noise_) + transform_covariance(B, C);
  double squared = 0;
  int kinds = 0;
  for (int k = 0; k < kLandmarkKinds; ++k) {
    const Vector6 shift = shifts_.col(k);
    squared += mahalanobis_squared<6>(shift, noise_);
    kinds += shift.isZero(0) ? 0 : 1;
  }
  const double inflation = 1 + kinds * (squared / kDegreesOfFreedom - 1);
  inflation_ = inflation < kMostInflation ? std::max(inflation, 1.0) : kMostInflation;
}

}  // namespace plvo
