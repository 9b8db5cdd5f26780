// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/shared_errors.hpp"

#include "plvo/math/se3.hpp"

namespace plvo {

SharedErrors::SharedErrors(const Exposure& exposure, double turning_rad_per_s, double depth_m)
    : exposure_(exposure), turning_(exposure.rolling() ? turning_rad_per_s : 0), depth_(depth_m) {}

Matrix<3, SharedField::kCount> SharedField::matrix() const {
  Matrix<3, kCount> F;
  F.block<3, kTurning>(0, 0) = -delay_s * skew(p);
  F.block<3, kDepth>(0, kTurning) = p * along.transpose();
  return F;
}

SharedField SharedErrors::field(const Vector3& p, double delay_s) const {
  SharedField field{p};
  if (turning_ > 0) field.delay_s = delay_s;
  if (depth_ > 0) {
    // Z (1, x, y, x² + y²), with x Z = X and y Z = Y.
    const double squared = p.x() * p.x() + p.y() * p.y();
    field.along = Vector4(p.z(), p.x(), p.y(), squared / p.z());
  }
  return field;
}

}  // namespace plvo
