// SPDX-License-Identifier: Apache-2.0
// Lenses, as OpenCV and ROS know them. With (x, y) = (X/Z, Y/Z), r² = x² + y² and θ = atan r:
//   rational      Brown–Conrady with a denominator (rational_polynomial): the radial part is
//                 (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶), the tangential one p1, p2.
//                 With k4 = k5 = k6 = 0 it is plumb_bob.
//   equidistant   the fisheye of Kannala and Brandt (PAMI 2006): r becomes
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

  // kInvalidArgument, saying which and what to do, for a coefficient that is no number or that the model does
  // not have, and for a rational or equidistant lens that bends back within `radius` (of X/Z, Y/Z) of the
  // axis. That plumb_bob does not is left to CameraModel::validate, which looks at the tangential part, too.
  Status validate(double radius) const;
};

// Normalised image coordinates (x/z, y/z) before the lens → after it. J_distort, when asked for, is ∂out/∂in.
Vector2 distort(const Distortion& lens, const Vector2& ideal, Matrix2* J_distort = nullptr);

// Its inverse, by Newton's method with a fixed number of steps: exact to rounding where validate() accepts
// the lens. What an equidistant lens images at a right angle to the axis or behind it has no ideal
// coordinates: very large ones in its direction are returned.
Vector2 undistort(const Distortion& lens, const Vector2& distorted);

}  // namespace plvo
