// SPDX-License-Identifier: Apache-2.0
// Errors that all features of the current frame have in common. They do not average out over features, so a
// model without them makes the estimate follow them and its covariance deny them. Two kinds, each smooth over
// the image, each with a Gaussian prior of mean zero:
//
//   turning  – how far the angular velocity during the exposure is off what was predicted; with a rolling
//              shutter it shears the image (3 parameters, rad/s);
//   depth    – a smooth error of the depth image, growing with the square of the depth as an error of
//              disparity does: 1, x, y and x² + y² times d² along the ray, x and y being X/Z and Y/Z
//              (4 parameters, 1/m).
//
// Each parameter moves all measured points p of the current camera frame along a field F(p): measured = true
// + F(p) β. The motion problem estimates β besides the motion and eliminates it (motion_problem.hpp), so that
// the motion's covariance contains it: nuisance parameters, as in bundle adjustment with self-calibration.
#pragma once

#include "plvo/camera/exposure.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

// How the parameters move a measured point: F(p) = [−delay [p]×, p alongᵀ].
struct NuisanceField {
  static constexpr int kAngularRate = 3, kDepth = 4;
  static constexpr int kCount = kAngularRate + kDepth;

  Vector3 p;
  double delay_s = 0;               // of the row that saw it, after the middle one; 0: no turning
  Vector4 along = Vector4::Zero();  // m; zero: no error of the depth

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
  // Of Fᵀ u what turning has.
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

  // There are none.
  NuisanceParameters() = default;
  // Their SDs: turning in rad/s (has no effect with a global shutter), depth in metres of error at 1 m; 0:
  // none of this kind. exposure: of the current frame.
  NuisanceParameters(const Exposure& exposure, double angular_rate_error_rad_per_s, double depth_m);

  bool any() const { return angular_rate_ > 0 || depth_ > 0; }
  // Prior SD of parameter k; 0: there is no such error.
  double sigma(int k) const { return k < NuisanceField::kAngularRate ? angular_rate_ : depth_; }

  // F(p).
  NuisanceField field(const Vector3& p) const {
    return field(p, angular_rate_ > 0 ? exposure_.delay_s(p) : 0);
  }
  // The same of a p that was exposed delay_s after the middle row.
  NuisanceField field(const Vector3& p, double delay_s) const;
  // F(p) β.
  Vector3 shift(const Vector3& p) const { return field(p) * value; }

  Vector value = Vector::Zero();  // β

 private:
  Exposure exposure_;
  double angular_rate_ = 0, depth_ = 0;
};

// What was found of them.
struct NuisanceEstimate {
  NuisanceParameters::Vector value = NuisanceParameters::Vector::Zero();
  NuisanceParameters::Vector variance = NuisanceParameters::Vector::Zero();
};

}  // namespace plvo
