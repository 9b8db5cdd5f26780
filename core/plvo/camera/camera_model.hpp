// SPDX-License-Identifier: Apache-2.0
// The camera: a pinhole with a lens (distortion.hpp). Pixel (0, 0) is the centre of the top-left pixel. The
// optical frame is x right, y down, z forward.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/camera/distortion.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

struct Pinhole {
  double fx = 525, fy = 525;      // px
  double cx = 319.5, cy = 239.5;  // px
};

// Time from the first to the last row of a Kinect v1's colour image: 26.1 ms by Ringaby & Forssén (ICCV
// 2011). On TUM's fr1/rpy, the error of plvo is smallest between 20 and 30 ms.
inline constexpr double kKinectReadout_s = 0.0261;

// Exposure time of depth. If it is not known, a depth pixel is assumed to be exposed together with the colour
// pixel at the same position, and the stamp of the depth image is ignored.
struct DepthTiming {
  bool known = false;
  // Time from the stamp of depth to the exposure of its middle row. Colour's middle row is exposed at
  // colour's stamp.
  double delay_s = 0;
  double readout_s = 0;  // like CameraModel::readout_s, but of the depth image
};

struct CameraModel {
  int width = 640, height = 480;  // px
  Pinhole pinhole;
  Distortion distortion;
  // Rolling shutter: time from the exposure of the first row to that of the last, in seconds. 0: global
  // shutter.
  double readout_s = 0;
  DepthTiming depth_timing = {};
  // Standard deviation of the difference between a colour stamp and the exposure of the middle row, in
  // seconds. The errors of different stamps are independent; 0 means exact stamps. A constant clock offset is
  // not part of it. Poses refer to the stamps, so the covariances of poses and motions include the camera's
  // motion during this time.
  double stamp_sigma_s = 0;

  // Returns kInvalidArgument and names the entry for NaN, a focal length out of range (focal_range.hpp), a
  // principal point outside the image, a readout or a standard deviation of the stamps that is negative or
  // above 0.1 s, a depth delay beyond ±0.1 s, or a lens that folds the image.
  Status validate() const;
};

// Smallest distance along z in metres. No sensor sees nearer points, and their projection changes without
// bound.
inline constexpr double kNearestSeen_m = 0.1;

// Projects p (camera frame, metres) to pixels with the pinhole alone. p.z() must be positive.
inline Vector2 project(const Pinhole& pinhole, const Vector3& p) {
  return {pinhole.fx * p.x() / p.z() + pinhole.cx, pinhole.fy * p.y() / p.z() + pinhole.cy};
}

// Derivative of project with respect to p, in px/m.
Matrix<2, 3> project_derivative(const Pinhole& pinhole, const Vector3& p);

// Equation (1): the point at pixel (u, v) with depth d (metres along z).
inline Vector3 back_project(const Pinhole& pinhole, double u, double v, double d) {
  return {(u - pinhole.cx) * d / pinhole.fx, (v - pinhole.cy) * d / pinhole.fy, d};
}

// Maps a pixel of the ideal pinhole to the pixel at which the lens images it.
Vector2 distort_pixel(const CameraModel& camera, const Vector2& ideal_px);

// Inverse of distort_pixel, exact to 1e-9 px for any lens that validate() accepts.
Vector2 undistort_pixel(const CameraModel& camera, const Vector2& distorted_px);

}  // namespace plvo
