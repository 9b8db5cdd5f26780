// SPDX-License-Identifier: Apache-2.0
// The measurements that points, lines and motion share: a 3D point and a 3D line of one frame, each with its
// covariance. In a reference it is a landmark, with a record.
#pragma once

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/camera/landmark_record.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

// P with cov(P), in the camera frame, metres.
struct Point3d {
  Vector3 p = Vector3::Zero();
  Matrix3 Sigma = Matrix3::Identity();
  LandmarkRecord record = LandmarkRecord();
};

// The segment between two points A and B, and the covariance (10) of the stacked 6-vector [A; B]. Camera
// frame, metres.
struct Line3d {
  Vector3 a = Vector3::Zero();
  Vector3 b = Vector3::Zero();
  Matrix6 Sigma = Matrix6::Identity();
  LandmarkRecord record = LandmarkRecord();
};

// Equations (1), (3), (4): the point at pixel (u, v) with depth d (metres), and its first-order covariance
// J_P diag(σ_p², σ_p², σ_d²) J_Pᵀ. J_P, if given, receives ∂P/∂(u, v, d).
Point3d observe_point(const Pinhole& pinhole, double u, double v, double depth_m, double sigma_p_px,
                      double sigma_d_m, Matrix3* J_P = nullptr);

}  // namespace plvo
