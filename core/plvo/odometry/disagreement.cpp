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
  const Matrix6 T = kMemory_s / (kMemory_s + elapsed_s) * A;
  shifts_ = T.lazyProduct(shifts_).eval() + pose.shifts - A.lazyProduct(last.shifts);
  noise_ =
      transform_covariance(T, noise_) + transform_covariance(derivative_by_motion(pose, T_current_from), C);
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
