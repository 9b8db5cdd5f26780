// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/distortion.hpp"

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// a + b s + c s² + d s³ and its derivative.
double cubic(double a, double b, double c, double d, double s) { return a + s * (b + s * (c + s * d)); }
double cubic_slope(double b, double c, double d, double s) { return b + s * (2 * c + s * 3 * d); }

Vector2 distort_rational(const Distortion& lens, const Vector2& ideal, Matrix2* J) {
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  // For plumb_bob the denominator is 1, and the division changes no bit.
  const double below = cubic(1, lens.k4, lens.k5, lens.k6, r2);
  const double radial = cubic(1, lens.k1, lens.k2, lens.k3, r2) / below;
  if (J != nullptr) {
    // d radial / d r²
    const double slope =
        (cubic_slope(lens.k1, lens.k2, lens.k3, r2) - radial * cubic_slope(lens.k4, lens.k5, lens.k6, r2)) /
        below;
    (*J)(0, 0) = radial + 2 * x * x * slope + 2 * lens.p1 * y + 6 * lens.p2 * x;
    (*J)(0, 1) = 2 * x * y * slope + 2 * lens.p1 * x + 2 * lens.p2 * y;
    (*J)(1, 0) = (*J)(0, 1);
    (*J)(1, 1) = radial + 2 * y * y * slope + 6 * lens.p1 * y + 2 * lens.p2 * x;
  }
  return {x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x),
          y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y};
}

// Distance from the centre at which a ray at the angle θ is imaged, and its derivative.
double fisheye(const Distortion& lens, double theta) {
  const double s = theta * theta;
  return theta * (1 + s * cubic(lens.k1, lens.k2, lens.k3, lens.k4, s));
}
double fisheye_slope(const Distortion& lens, double theta) {
  const double s = theta * theta;
  return 1 + s * cubic(3 * lens.k1, 5 * lens.k2, 7 * lens.k3, 9 * lens.k4, s);
}

Vector2 distort_equidistant(const Distortion& lens, const Vector2& ideal, Matrix2* J) {
  const double r2 = ideal.squaredNorm();
  const double r = sqrt(r2);
  if (!(r > 1e-9)) {  // the distortion is 1 + O(r²) here
    if (J != nullptr) J->setIdentity();
    return ideal;
  }
  const double theta = atan2(r, 1);
  const double radial = fisheye(lens, theta) / r;
  if (J != nullptr) {
    const double along =
        fisheye_slope(lens, theta) / (1 + r2);  // derivative of the imaged distance with respect to r
    *J = radial * Matrix2::Identity() + (along - radial) / r2 * ideal * ideal.transpose();
  }
  return radial * ideal;
}

Vector2 undistort_rational(const Distortion& lens, const Vector2& target) {
  // Lenses with a denominator are wide and need more steps. plumb_bob keeps its count, so its results stay
  // bit-identical.
  const int steps = lens.is_plumb_bob() ? 8 : 24;
  constexpr double kLongest = 1;  // limit of one step, for points beyond the lens's valid range
  Vector2 ideal = target;
  for (int i = 0; i < steps; ++i) {
    Matrix2 J;
    const Vector2 error = distort_rational(lens, ideal, &J) - target;
    const double determinant = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    if (!(determinant > 1e-6)) break;
    Vector2 step((J(1, 1) * error.x() - J(0, 1) * error.y()) / determinant,
                 (J(0, 0) * error.y() - J(1, 0) * error.x()) / determinant);
    const double length2 = step.squaredNorm();
    if (!(length2 < 1e12)) break;
    if (length2 > kLongest) step *= kLongest / sqrt(length2);
    ideal -= step;
  }
  return ideal;
}

Vector2 undistort_equidistant(const Distortion& lens, const Vector2& target) {
  const double distance = sqrt(target.squaredNorm());
  if (!(distance > 1e-9)) return target;
  // Newton's method for the angle, with a bracket as a safeguard.
  constexpr int kNewtonSteps = 24;
  double least = 0;
  double most = kPi / 2 - 1e-4;
  double theta = distance < most ? distance : most;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const double error = fisheye(lens, theta) - distance;
    (error > 0 ? most : least) = theta;
    theta -= error / fisheye_slope(lens, theta);
    if (!(theta >= least && theta <= most)) theta = 0.5 * (least + most);
  }
  return sin(theta) / (cos(theta) * distance) * target;
}

Status folds_at(double theta, const char* what, const char* coefficients) {
  return Status(StatusCode::kInvalidArgument, what)
      .append(static_cast<std::ptrdiff_t>(theta * (180 / kPi)))
      .append(" degrees from the axis; check ")
      .append(coefficients)
      .append(" and their order, or calibrate again with the target in the image's corners, too");
}

constexpr int kRadialSteps = 512;     // steps along the radius, less than 1 px each
constexpr double kLeastSlope = 0.02;  // smallest slope of the imaged distance with respect to r and to θ

Status check_rational(const Distortion& lens, double radius) {
  // Compares adjacent steps, which also detects a pole.
  double before = 0;
  for (int i = 1; i <= kRadialSteps; ++i) {
    const double r = radius * i / kRadialSteps;
    const double s = r * r;
    const double imaged = r * cubic(1, lens.k1, lens.k2, lens.k3, s) / cubic(1, lens.k4, lens.k5, lens.k6, s);
    if (!(imaged - before >= kLeastSlope * radius / kRadialSteps))
      return folds_at(atan2(r, 1), "the rational distortion folds the image ", "k1 k2 p1 p2 k3 k4 k5 k6");
    before = imaged;
  }
  return {};
}

Status check_equidistant(const Distortion& lens, double radius) {
  const double widest = atan2(radius, 1);
  for (int i = 1; i <= kRadialSteps; ++i) {
    const double theta = widest * i / kRadialSteps;
    if (!(fisheye_slope(lens, theta) >= kLeastSlope))
      return folds_at(theta, "the equidistant distortion folds the image ", "k1 k2 k3 k4");
  }
  return {};
}

}  // namespace

Status Distortion::validate(double radius) const {
  for (const double k : {k1, k2, p1, p2, k3, k4, k5, k6})
    if (!is_finite(k))
      return {StatusCode::kInvalidArgument,
              "the distortion coefficients k1 k2 p1 p2 k3 (k4 k5 k6) must be numbers"};
  if (model == LensModel::kEquidistant) {
    if (p1 != 0 || p2 != 0 || k5 != 0 || k6 != 0)
      return {StatusCode::kInvalidArgument,
              "an equidistant lens has k1 k2 k3 k4 alone; p1 p2 k5 k6 must be 0"};
    return check_equidistant(*this, radius);
  }
  return is_plumb_bob() ? Status() : check_rational(*this, radius);
}

Vector2 distort(const Distortion& lens, const Vector2& ideal, Matrix2* J_distort) {
  return lens.model == LensModel::kEquidistant ? distort_equidistant(lens, ideal, J_distort)
                                               : distort_rational(lens, ideal, J_distort);
}

Vector2 undistort(const Distortion& lens, const Vector2& distorted) {
  return lens.model == LensModel::kEquidistant ? undistort_equidistant(lens, distorted)
                                               : undistort_rational(lens, distorted);
}

}  // namespace plvo
