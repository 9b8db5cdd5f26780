// SPDX-License-Identifier: Apache-2.0
// What track() says about one frame. Every number in it is finite, whatever the frame was; rotations are
// rotations; covariances are symmetric and positive semidefinite to kCovarianceTolerance, and within the
// bound of covariance.hpp.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

enum class TrackState : std::uint8_t {
  // The first usable frame, from which tracking starts; or, where the status is not ok(), none yet. Where it
  // is ok() and has a message, a new world starts: see Odometry::track.
  kInitialising,
  kTracking,   // the pose is new
  kLost,       // status says why; the pose is the last good one; the next good frame goes on from there
  kPredicted,  // nothing could be seen, status says why; the pose is new, from the priors alone
};
const char* to_string(TrackState state);

enum class Stage : std::uint8_t { kImage, kPoints, kLines, kMatching, kMotion };
inline constexpr int kStageCount = 5;
const char* to_string(Stage stage);

// Of this frame; the first three of points, where none were looked for (ReferenceConfig::recent_frames), of
// the latest frame where they were.
struct FeatureCounts {
  int detected = 0;    // found, before the selection
  int dropped = 0;     // found, but beyond the capacity
  int with_depth = 0;  // lifted to 3D
  int matched = 0;     // to the reference, putative
  int inliers = 0;     // of the motion
};

struct TrackResult {
  TrackState state = TrackState::kInitialising;
  Status status;
  std::int64_t stamp_ns = 0;
  std::int64_t reference_stamp_ns = 0;  // of the frame that this one was matched against

  // Camera to world; the world is the camera frame of the first frame, unless Config::level_world or
  // set_pose() say otherwise. Covariance of the ⊞-perturbation (position, then orientation; m and rad) in the
  // axes of the world, accumulated from the motions, with what the stamp errs
  // (CameraModel::stamp_sigma_s) at this frame alone. While lost, it is that of the last good pose; of a
  // predicted pose it has grown by what the priors leave open.
  Se3 T_world_camera;
  Matrix6 pose_covariance = Matrix6::Zero();

  // Motion with respect to the reference, X_camera = T_camera_reference X_reference, and its covariance: C_H
  // (23), what the matches with a keyframe err alike in every frame (common_mode_error.hpp), and what both
  // stamps err.
  Se3 T_camera_reference;
  Matrix6 motion_covariance = Matrix6::Zero();

  FeatureCounts points;
  FeatureCounts lines;
  // The pose was put right: the view of a keyframe was recognised that is older than a loss.
  bool returned = false;
  int ransac_iterations = 0;
  int lm_iterations = 0;
  int feature_step = 0;                              // of Config::budget; 0: all the features that fit
  double mean_brightness = 0;                        // of the grey image, 0 … 255
  std::array<std::int64_t, kStageCount> stage_ns{};  // zero without Config::stage_clock
};

// Looked at where a result leaves the library: makes its covariances what is said above, bit by bit the same
// where they are. False where a number is not finite or a rotation is none: then nobody may have it.
bool make_sound(TrackResult& result);

}  // namespace plvo
