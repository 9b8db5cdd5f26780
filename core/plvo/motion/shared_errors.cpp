// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/shared_errors.hpp"

#include "plvo/math/se3.hpp"

namespace plvo {

SharedErrors::SharedErrors(const Exposure& exposure, double turning_rad_per_s, double depth_m)
    : exposure_(exposure), turning_(exposure.rolling() ? turning_rad_per_s : 0), depth_(depth_m) {}

Matrix<3, SharedErrors::kCount> SharedErrors::fields(const Vector3& p, double delay_s) const {
  Matrix<3, kCount> F = Matrix<3, kCount>::Zero();
  if (turning_ > 0) F.block<3, kTurning>(0, 0) = -delay_s * skew(p);
  if (depth_ > 0) {
    const double x = p.x() / p.z();
    const double y = p.y() / p.z();
    F.block<3, kDepth>(0, kTurning) = p.z() * p * Vector4(1, x, y, x * x + y * y).transpose();
  }
  return F;
}

}  // namespace plvo
