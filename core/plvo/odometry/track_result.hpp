// SPDX-License-Identifier: Apache-2.0
// The result of track() for one frame. All numbers are finite, whatever the frame; rotations are valid;
// covariances are symmetric and positive semidefinite to kCovarianceTolerance, and within the bound of
// covariance.hpp.
#pragma once

#include <cstdint>
#include <optional>

#include "plvo/base/status.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/math/covariance.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/odometry/features/feature_counts.hpp"
#include "plvo/odometry/stage.hpp"

namespace plvo {

enum class TrackState : std::uint8_t {
  // The frame from which tracking starts: the first usable one of a world, or, with `restarted`, one after a
  // long loss. If the status is not ok(), there has been no usable frame yet.
  kInitialising,
  kTracking,  // the pose is new
  kLost,  // status gives the reason; the pose is the last good one, and the next good frame continues from it
  kPredicted,  // no usable features, status gives the reason; the pose is new, from the priors alone
};
const char* to_string(TrackState state);

struct TrackResult {
  TrackState state = TrackState::kInitialising;
  Status status;
  std::int64_t stamp_ns = 0;
  std::int64_t reference_stamp_ns = 0;  // of the frame with which this one was matched

  // Camera to world. The world is the camera frame of the first frame, unless Config::level_world or
  // set_pose() define another. The covariance is that of the ⊞-perturbation (position, then orientation; m
  // and rad) in the axes of the world. It accumulates those of the motions, contains what points, lines and
  // surfaces say apart (PoseWithCovariance::shifts), and adds the stamp error (CameraModel::stamp_sigma_s) of
  // this frame alone. While lost, pose and covariance are those of the last
  // good frame; for a predicted pose the covariance includes the uncertainty of the priors.
  Se3 T_world_camera;
  Matrix6 pose_covariance = Matrix6::Zero();
  // Number of that world, from 0. Poses in different worlds have no known relation. The number rises with
  // Odometry::reset(), and after a loss so long that the position may be anywhere.
  std::uint32_t world = 0;

  // Motion with respect to the reference, X_camera = T_camera_reference X_reference. Its covariance is the
  // sum of C_H (23) and the common-mode error of the matches with a keyframe (common_mode_error.hpp), times
  // the factor of disagreement.hpp, plus the errors of both stamps.
  Se3 T_camera_reference;
  Matrix6 motion_covariance = Matrix6::Zero();

  FeatureCounts points;
  FeatureCounts lines;
  // The pose was corrected: the camera recognised the view of a keyframe from before a loss.
  bool relocalised = false;
  // Tracking goes on in the same world after a loss, and the images did not observe the motion up to this
  // frame, or up to its reference. The covariance of the pose includes that motion.
  bool restarted = false;
  // The colour image is that of the frame before, so no motion was measured: the pose is predicted, and its
  // covariance includes the process noise. The state is kTracking, and the status is ok() with a message.
  bool repeated = false;
  // By how much points, lines and surfaces disagree about the motion: the factor of disagreement.hpp, of the
  // last half second, 1 … 1000. 1: they agree as well as the noise allows. Above 100 the status says so.
  double disagreement = 1;
  int ransac_iterations = 0;
  int lm_iterations = 0;
  int feature_step = 0;        // of Config::budget; 0: all the features that fit
  double mean_brightness = 0;  // of the grey image, 0 … 255
  StageTimes stage_ns{};       // zero without Config::stage_clock
};

// The rotation of a result, for ImuIntegrator::correct(); empty if the frame was not tracked and
// does not start a trajectory.
std::optional<ObservedRotation> observed_rotation(const TrackResult& result);

// Called where a result leaves the library. Makes its covariances valid as described above; valid ones stay
// the same bit by bit. Returns false where a number is not finite or a rotation is invalid: the caller must
// not get such a result.
bool make_sound(TrackResult& result);

}  // namespace plvo
