// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/camera_model.hpp"

#include <Eigen/LU>

namespace plvo {
namespace {

bool finite(double x) { return x - x == 0; }

}  // namespace

Status CameraModel::validate() const {
  const auto invalid = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, "camera calibration: ").append(what);
  };
  if (width < 32 || height < 32) return invalid("the image must be at least 32x32 pixels");
  if (!finite(pinhole.fx) || !finite(pinhole.fy) || pinhole.fx <= 0 || pinhole.fy <= 0)
    return invalid("fx and fy must be positive numbers (pixels)");
  if (!finite(pinhole.cx) || !finite(pinhole.cy) || pinhole.cx < 0 || pinhole.cx >= width || pinhole.cy < 0 ||
      pinhole.cy >= height)
    return invalid("cx and cy must lie inside the image (pixels)");
  const Distortion& lens = distortion;
  if (!finite(lens.k1) || !finite(lens.k2) || !finite(lens.p1) || !finite(lens.p2) || !finite(lens.k3))
    return invalid("the distortion coefficients k1 k2 p1 p2 k3 must be numbers");
  if (!(readout_s >= 0 && readout_s <= 0.1)) return invalid("the readout must lie between 0 and 0.1 s");
  if (!(depth_timing.readout_s >= 0 && depth_timing.readout_s <= 0.1))
    return invalid("the readout of depth must lie between 0 and 0.1 s");
  if (!(depth_timing.delay_s >= -0.1 && depth_timing.delay_s <= 0.1))
    return invalid("the delay of depth must lie between -0.1 and 0.1 s");
  // The lens must keep the order of the pixels: the Jacobian of the distortion keeps a positive determinant.
  constexpr int kSteps = 16;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Vector2 ideal((column * (width - 1.0) / kSteps - pinhole.cx) / pinhole.fx,
                          (row * (height - 1.0) / kSteps - pinhole.cy) / pinhole.fy);
      Matrix2 J;
      distort(lens, ideal, &J);
      if (!(J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0) > 0.05))
        return invalid("the distortion folds the image; check k1 k2 p1 p2 k3 and their order");
    }
  }
  return {};
}

Vector2 project(const Pinhole& pinhole, const Vector3& p) {
  return {pinhole.fx * p.x() / p.z() + pinhole.cx, pinhole.fy * p.y() / p.z() + pinhole.cy};
}

Vector3 back_project(const Pinhole& pinhole, double u, double v, double d) {
  return {(u - pinhole.cx) * d / pinhole.fx, (v - pinhole.cy) * d / pinhole.fy, d};
}

Vector2 distort(const Distortion& lens, const Vector2& ideal, Matrix2* J_distort) {
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
  if (J_distort != nullptr) {
    const double slope = lens.k1 + r2 * (2 * lens.k2 + r2 * 3 * lens.k3);  // d radial / d r²
    (*J_distort)(0, 0) = radial + 2 * x * x * slope + 2 * lens.p1 * y + 6 * lens.p2 * x;
    (*J_distort)(0, 1) = 2 * x * y * slope + 2 * lens.p1 * x + 2 * lens.p2 * y;
    (*J_distort)(1, 0) = (*J_distort)(0, 1);
    (*J_distort)(1, 1) = radial + 2 * y * y * slope + 6 * lens.p1 * y + 2 * lens.p2 * x;
  }
  return {x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x),
          y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y};
}

Vector2 distort_pixel(const CameraModel& camera, const Vector2& ideal_px) {
  const Pinhole& k = camera.pinhole;
  const Vector2 d = distort(camera.distortion, {(ideal_px.x() - k.cx) / k.fx, (ideal_px.y() - k.cy) / k.fy});
  return {d.x() * k.fx + k.cx, d.y() * k.fy + k.cy};
}

Vector2 undistort_pixel(const CameraModel& camera, const Vector2& distorted_px) {
  const Pinhole& k = camera.pinhole;
  const Vector2 target((distorted_px.x() - k.cx) / k.fx, (distorted_px.y() - k.cy) / k.fy);
  Vector2 ideal = target;
  constexpr int kNewtonSteps = 8;
  for (int i = 0; i < kNewtonSteps; ++i) {
    Matrix2 J;
    const Vector2 error = distort(camera.distortion, ideal, &J) - target;
    const double determinant = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    if (!(determinant > 1e-6)) break;
    ideal.x() -= (J(1, 1) * error.x() - J(0, 1) * error.y()) / determinant;
    ideal.y() -= (J(0, 0) * error.y() - J(1, 0) * error.x()) / determinant;
  }
  return {ideal.x() * k.fx + k.cx, ideal.y() * k.fy + k.cy};
}

}  // namespace plvo
