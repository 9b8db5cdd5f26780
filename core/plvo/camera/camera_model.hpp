// SPDX-License-Identifier: Apache-2.0
// The camera: a pinhole and a lens (distortion.hpp).
// Pixel coordinates put (0, 0) at the centre of the top-left pixel; the optical frame is x right, y down, z
// forward.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/camera/distortion.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

struct Pinhole {
  double fx = 525, fy = 525;      // px
  double cx = 319.5, cy = 239.5;  // px
};

// From the first row of a Kinect v1's colour image to the last: 26.1 ms by Ringaby & Forssén (ICCV 2011). On
// TUM's fr1/rpy our error is least between 20 and 30 ms.
inline constexpr double kKinectReadout_s = 0.0261;

// When depth is exposed. Where it is not known, a depth pixel is taken to be exposed with the colour pixel of
// the same place, and the depth image's stamp is not looked at.
struct DepthTiming {
  bool known = false;
  // Depth's middle row is exposed so long after depth's stamp; colour's middle row, at colour's stamp.
  double delay_s = 0;
  double readout_s = 0;  // as CameraModel::readout_s, of the depth image
};

struct CameraModel {
  int width = 640, height = 480;  // px
  Pinhole pinhole;
  Distortion distortion;
  // Rolling shutter: from the exposure of the first row to that of the last, in seconds. 0: all rows at once.
  double readout_s = 0;
  DepthTiming depth_timing = {};
  // How far a colour stamp is off the exposure of the middle row, each on its own: standard deviation in
  // seconds; 0: exact. A clock that is off by a constant is none of it. Poses are those of the stamps, so
  // their covariance and that of the motions hold what the camera moves in this time.
  double stamp_sigma_s = 0;

  // kInvalidArgument, naming the entry, for NaN, a focal length out of range (focal_range.hpp), a principal
  // point outside the image, a readout or a deviation of the stamps that is negative or above 0.1 s, a depth
  // delay beyond ±0.1 s, or a lens that folds back on itself inside the image.
  Status validate() const;
};

// No sensor sees what is nearer along z, and where it would be seen changes without bound: m.
inline constexpr double kNearestSeen_m = 0.1;

// Projects p (camera frame, metres) to pixels with the pinhole alone. p.z() must be positive.
inline Vector2 project(const Pinhole& pinhole, const Vector3& p) {
  return {pinhole.fx * p.x() / p.z() + pinhole.cx, pinhole.fy * p.y() / p.z() + pinhole.cy};
}

// Its derivative by p, px/m.
Matrix<2, 3> project_derivative(const Pinhole& pinhole, const Vector3& p);

// Equation (1): the point at pixel (u, v) with depth d (metres along z).
inline Vector3 back_project(const Pinhole& pinhole, double u, double v, double d) {
  return {(u - pinhole.cx) * d / pinhole.fx, (v - pinhole.cy) * d / pinhole.fy, d};
}

// The pixel at which the lens images what an ideal pinhole would image at (u, v).
Vector2 distort_pixel(const CameraModel& camera, const Vector2& ideal_px);

// Inverse of distort_pixel: exact to 1e-9 px within any lens that validate() accepts.
Vector2 undistort_pixel(const CameraModel& camera, const Vector2& distorted_px);

}  // namespace plvo
