// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/nuisance_parameters.hpp"

#include "plvo/math/se3.hpp"

namespace plvo {

NuisanceParameters::NuisanceParameters(const Exposure& exposure, double angular_rate_error_rad_per_s,
                                       double depth_m)
    : exposure_(exposure),
      angular_rate_(exposure.rolling() ? angular_rate_error_rad_per_s : 0),
      depth_(depth_m) {}

Matrix<3, NuisanceField::kCount> NuisanceField::matrix() const {
  Matrix<3, kCount> F;
  F.block<3, kAngularRate>(0, 0) = -delay_s * skew(p);
  F.block<3, kDepth>(0, kAngularRate) = p * along.transpose();
  return F;
}

NuisanceField NuisanceParameters::field(const Vector3& p, double delay_s) const {
  NuisanceField field{p};
  if (angular_rate_ > 0) field.delay_s = delay_s;
  if (depth_ > 0) {
    // Z (1, x, y, x² + y²), with x Z = X and y Z = Y.
    const double squared = p.x() * p.x() + p.y() * p.y();
    field.along = Vector4(p.z(), p.x(), p.y(), squared / p.z());
  }
  return field;
}

}  // namespace plvo
