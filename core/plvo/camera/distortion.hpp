// SPDX-License-Identifier: Apache-2.0
// Lens models, as in OpenCV and ROS. With (x, y) = (X/Z, Y/Z), r² = x² + y² and θ = atan r:
//   rational      Brown–Conrady with a denominator (rational_polynomial): the radial factor is
//                 (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶); p1 and p2 are tangential.
//                 With k4 = k5 = k6 = 0 it is plumb_bob.
//   equidistant   the fisheye model of Kannala and Brandt (PAMI 2006): r becomes
//                 θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸).
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

enum class LensModel : std::uint8_t { kRational, kEquidistant };

struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  // in the order of OpenCV and ROS
  double k4 = 0, k5 = 0, k6 = 0;
  LensModel model = LensModel::kRational;  // kEquidistant uses k1 k2 k3 k4; the others are 0

  bool is_plumb_bob() const { return model == LensModel::kRational && k4 == 0 && k5 == 0 && k6 == 0; }
  bool is_zero() const { return is_plumb_bob() && k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }

  // Returns kInvalidArgument, with the reason and a remedy, for a coefficient that is not a number or that
  // the model does not have, and for a rational or equidistant lens that folds the image within `radius` of
  // the axis (in units of X/Z, Y/Z). CameraModel::validate checks plumb_bob for folds, because it also
  // considers the tangential part.
  Status validate(double radius) const;
};

// Maps normalised image coordinates (x/z, y/z) before the lens to those after it. J_distort, if given,
// receives ∂out/∂in.
Vector2 distort(const Distortion& lens, const Vector2& ideal, Matrix2* J_distort = nullptr);

// Inverse of distort, by Newton's method with a fixed number of steps. It is exact to rounding if validate()
// accepts the lens. Points that an equidistant lens images at a right angle to the axis or behind it have no
// ideal coordinates; the function returns very large ones in their direction.
Vector2 undistort(const Distortion& lens, const Vector2& distorted);

}  // namespace plvo
