// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/camera_model.hpp"

#include <algorithm>

#include "plvo/camera/focal_range.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

Status CameraModel::validate() const {
  const auto invalid = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, "camera calibration: ").append(what);
  };
  if (width < 32 || height < 32) return invalid("the image must be at least 32x32 pixels");
  const auto is_focal = [](double f) { return f >= kLeastFocal_px && f <= kMostFocal_px; };
  if (!is_focal(pinhole.fx) || !is_focal(pinhole.fy))
    return invalid("fx and fy must be numbers from ")
        .append(std::ptrdiff_t{kLeastFocal_px})
        .append(" to ")
        .append(std::ptrdiff_t{kMostFocal_px})
        .append(" (pixels)");
  if (!(pinhole.cx >= 0 && pinhole.cx < width && pinhole.cy >= 0 && pinhole.cy < height))
    return invalid("cx and cy must lie inside the image (pixels)");
  // Distance to the farthest corner of the undistorted image.
  const Vector2 corner(std::max(pinhole.cx, width - 1 - pinhole.cx) / pinhole.fx,
                       std::max(pinhole.cy, height - 1 - pinhole.cy) / pinhole.fy);
  if (const Status lens = distortion.validate(sqrt(corner.squaredNorm())); !lens.ok())
    return invalid(lens.message());
  if (!(readout_s >= 0 && readout_s <= 0.1)) return invalid("the readout must lie between 0 and 0.1 s");
  if (!(depth_timing.readout_s >= 0 && depth_timing.readout_s <= 0.1))
    return invalid("the readout of depth must lie between 0 and 0.1 s");
  if (!(depth_timing.delay_s >= -0.1 && depth_timing.delay_s <= 0.1))
    return invalid("the delay of depth must lie between -0.1 and 0.1 s");
  if (!(stamp_sigma_s >= 0 && stamp_sigma_s <= 0.1))
    return invalid("the standard deviation of the stamps must lie between 0 and 0.1 s");
  if (distortion.model == LensModel::kEquidistant) return {};  // it has no tangential part
  // The lens must preserve the order of the pixels, so the determinant of the distortion's Jacobian must stay
  // positive.
  constexpr int kSteps = 16;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Vector2 ideal((column * (width - 1.0) / kSteps - pinhole.cx) / pinhole.fx,
                          (row * (height - 1.0) / kSteps - pinhole.cy) / pinhole.fy);
      Matrix2 J;
      distort(distortion, ideal, &J);
      if (!(J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0) > 0.05))
        return invalid("the distortion folds the image; check k1 k2 p1 p2 k3 (k4 k5 k6) and their order");
    }
  }
  return {};
}

Matrix<2, 3> project_derivative(const Pinhole& pinhole, const Vector3& p) {
  const double fx = pinhole.fx / p.z();
  const double fy = pinhole.fy / p.z();
  Matrix<2, 3> J;
  J << fx, 0, -fx * p.x() / p.z(), 0, fy, -fy * p.y() / p.z();
  return J;
}

Vector2 distort_pixel(const CameraModel& camera, const Vector2& ideal_px) {
  const Pinhole& k = camera.pinhole;
  const Vector2 d = distort(camera.distortion, {(ideal_px.x() - k.cx) / k.fx, (ideal_px.y() - k.cy) / k.fy});
  return {d.x() * k.fx + k.cx, d.y() * k.fy + k.cy};
}

Vector2 undistort_pixel(const CameraModel& camera, const Vector2& distorted_px) {
  const Pinhole& k = camera.pinhole;
  const Vector2 target((distorted_px.x() - k.cx) / k.fx, (distorted_px.y() - k.cy) / k.fy);
  const Vector2 ideal = undistort(camera.distortion, target);
  return {ideal.x() * k.fx + k.cx, ideal.y() * k.fy + k.cy};
}

}  // namespace plvo
