// SPDX-License-Identifier: Apache-2.0
// Errors that all features of the current frame share. They do not average out over the features: without a
// model of them they bias the estimate, and its covariance does not contain them. There are two groups. Each
// is smooth over the image and has a Gaussian prior of mean zero:
//
//   angular rate – the error of the predicted angular velocity during the exposure; with a rolling shutter it
//                  shears the image (3 parameters, rad/s);
//   depth        – a smooth error of the depth image that grows with the square of the depth, as an error of
//                  disparity does: 1, x, y and x² + y² times d² along the ray, with x = X/Z and y = Y/Z
//                  (4 parameters, 1/m).
//
// Each parameter moves all measured points p of the current camera frame along a field F(p): measured = true
// + F(p) β. The motion problem estimates β jointly with the motion and eliminates it (motion_problem.hpp), so
// the motion's covariance contains its uncertainty. β is a vector of nuisance parameters, as in bundle
// adjustment with self-calibration.
#pragma once

#include "plvo/camera/exposure.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

// The derivative of a measured point with respect to the parameters: F(p) = [−delay [p]×, p alongᵀ].
struct NuisanceField {
  static constexpr int kAngularRate = 3, kDepth = 4;
  static constexpr int kCount = kAngularRate + kDepth;

  Vector3 p;
  double delay_s = 0;               // row time relative to the middle row; 0: no angular-rate error
  Vector4 along = Vector4::Zero();  // m; zero: no depth error

  // F β.
  Vector3 operator*(const Vector<kCount>& beta) const {
    return along.dot(beta.tail<kDepth>()) * p - angular_rate(beta.head<kAngularRate>());
  }
  // Fᵀ u.
  Vector<kCount> transpose_times(const Vector3& u) const {
    Vector<kCount> result;
    result.head<kAngularRate>() = angular_rate(u);
    result.tail<kDepth>() = u.dot(p) * along;
    return result;
  }
  // The angular-rate part of Fᵀ u.
  Vector3 angular_rate(const Vector3& u) const {  // −delay u × p
    return {delay_s * (u.z() * p.y() - u.y() * p.z()), delay_s * (u.x() * p.z() - u.z() * p.x()),
            delay_s * (u.y() * p.x() - u.x() * p.y())};
  }
  Matrix<3, kCount> matrix() const;
};

class NuisanceParameters {
 public:
  static constexpr int kCount = NuisanceField::kCount;
  using Vector = plvo::Vector<kCount>;

  // No nuisance parameters.
  NuisanceParameters() = default;
  // SDs of the priors: angular-rate error in rad/s (no effect with a global shutter), depth error in metres
  // at 1 m; 0 disables a group. exposure: of the current frame.
  NuisanceParameters(const Exposure& exposure, double angular_rate_error_rad_per_s, double depth_m);

  bool any() const { return angular_rate_ > 0 || depth_ > 0; }
  // Prior SD of parameter k; 0 if its group is disabled.
  double sigma(int k) const { return k < NuisanceField::kAngularRate ? angular_rate_ : depth_; }

  // F(p).
  NuisanceField field(const Vector3& p) const {
    return field(p, angular_rate_ > 0 ? exposure_.delay_s(p) : 0);
  }
  // F(p) of a point that was exposed delay_s after the middle row.
  NuisanceField field(const Vector3& p, double delay_s) const;
  // F(p) β.
  Vector3 shift(const Vector3& p) const { return field(p) * value; }

  Vector value = Vector::Zero();  // β

 private:
  Exposure exposure_;
  double angular_rate_ = 0, depth_ = 0;
};

// Estimated nuisance parameters and their variances.
struct NuisanceEstimate {
  NuisanceParameters::Vector value = NuisanceParameters::Vector::Zero();
  NuisanceParameters::Vector variance = NuisanceParameters::Vector::Zero();
};

}  // namespace plvo
