// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_prior.hpp"

#include "plvo/math/cholesky.hpp"
#include "plvo/math/covariance.hpp"

namespace plvo {
namespace {

constexpr double kLeastVariance = 1e-16, kMostVariance = kMostPositionVariance;
constexpr double kFarthest_m = 1000;

Status refuse(const char* part, const char* requirement) {
  return Status(StatusCode::kInvalidArgument, "prior: ").append(part).append(" ").append(requirement);
}

bool is_positive_definite_covariance(const Matrix3& C) {
  Cholesky<3> cholesky;
  return is_covariance(C) && C.diagonal().minCoeff() >= kLeastVariance &&
         C.diagonal().maxCoeff() <= kMostVariance && cholesky.factor(C);
}

constexpr const char* kCovariance =
    "must have a symmetric, positive definite covariance with variances from 1e-16 to 1e6";

}  // namespace

Status MotionPrior::validate() const {
  if (rotation && !is_rotation(rotation->R_now_before))
    return refuse("rotation", "must be a rotation matrix");
  if (rotation && !is_positive_definite_covariance(rotation->covariance))
    return refuse("rotation", kCovariance);
  if (translation && !(translation->t_now_before.allFinite() &&
                       translation->t_now_before.cwiseAbs().maxCoeff() <= kFarthest_m))
    return refuse("translation", "must be finite and at most 1000 m");
  if (translation && !is_positive_definite_covariance(translation->covariance))
    return refuse("translation", kCovariance);
  if (!gravity) return {};
  const double length_squared = gravity->down.squaredNorm();
  if (!(length_squared > 1e-12 && length_squared < 1e12))
    return refuse("gravity", "must be a finite direction with a length");
  if (!is_positive_definite_covariance(gravity->covariance)) return refuse("gravity", kCovariance);
  if (!(gravity->offset_sigma >= 0 && gravity->offset_sigma <= 1))
    return refuse("gravity", "must have an offset_sigma between 0 and 1");
  return {};
}

}  // namespace plvo
