// SPDX-License-Identifier: Apache-2.0
// What every result of track() must be, looked at with other means than the core's own: finite numbers,
// rotations, covariances that are symmetric and positive semidefinite.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

#include "plvo/odometry/track_result.hpp"

namespace plvo::test {

// Tolerance of correlations, that is relative to the standard deviations.
inline constexpr double kSoundTolerance = 1e-8;
// Bounds on the variances, in m² or rad².
inline constexpr double kMostVariance[6] = {1e6, 1e6, 1e6, 9.87, 9.87, 9.87};

inline bool is_sound_covariance(const Matrix6& C) {
  if (!C.allFinite()) return false;
  Eigen::Matrix<double, 6, 6> correlation;
  for (int i = 0; i < 6; ++i) {
    if (!(C(i, i) >= 0 && C(i, i) <= kMostVariance[i] * (1 + kSoundTolerance))) return false;
    for (int j = 0; j < 6; ++j) {
      const double deviations = std::sqrt(C(i, i)) * std::sqrt(C(j, j));
      if (!(std::abs(C(i, j) - C(j, i)) <= kSoundTolerance * deviations)) return false;
      if (deviations == 0 && i != j && C(i, j) != 0) return false;
      correlation(i, j) = deviations == 0 ? (i == j ? 1 : 0) : C(i, j) / deviations;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(correlation, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -kSoundTolerance;
}

inline bool is_sound_pose(const Se3& T) {
  return T.R.allFinite() && T.t.allFinite() &&
         (T.R * T.R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() <= 1e-6 &&
         T.R.col(0).cross(T.R.col(1)).dot(T.R.col(2)) > 0;
}

// A reason when there is no new pose, and numbers that fit the state.
inline bool is_sound_state(const TrackResult& result) {
  switch (result.state) {
    case TrackState::kInitialising: return !result.relocalised;
    case TrackState::kTracking:
      return result.status.ok() && !(result.repeated && (result.relocalised || result.restarted));
    case TrackState::kLost:
    case TrackState::kPredicted:
      return !result.status.ok() && result.status.message()[0] != '\0' && !result.relocalised &&
             !result.restarted;
  }
  return false;
}

inline bool is_sound(const TrackResult& result) {
  return is_sound_pose(result.T_world_camera) && is_sound_pose(result.T_camera_reference) &&
         is_sound_covariance(result.pose_covariance) && is_sound_covariance(result.motion_covariance) &&
         is_sound_state(result) && result.mean_brightness >= 0 && result.mean_brightness <= 255 &&
         result.disagreement >= 1 && result.disagreement <= 1000;
}

}  // namespace plvo::test
