// SPDX-License-Identifier: Apache-2.0
// The results of tracking a simulated sequence, and its true poses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "plvo/math/cholesky.hpp"
#include "plvo/odometry/odometry.hpp"
#include "simulator_support.hpp"
#include "test_limits.hpp"

namespace plvo::test {

inline double nees(const Vector6& error, const Matrix6& covariance) {
  Cholesky<6> cholesky;
  EXPECT_TRUE(cholesky.factor(covariance));
  return error.dot(cholesky.solve(error));
}

struct TrackedSequence {
  std::vector<TrackResult> results;
  std::vector<Se3> truth;  // at the results' stamps

  // The frame that frame i's motion is from.
  std::size_t reference(std::size_t i) const {
    const auto is_reference = [&](const TrackResult& result) {
      return result.stamp_ns == results[i].reference_stamp_ns;
    };
    return static_cast<std::size_t>(std::find_if(results.begin(), results.end(), is_reference) -
                                    results.begin());
  }
  Vector6 error_of_motion(std::size_t i) const {
    return boxminus(results[i].T_camera_reference, truth[i].inverse() * truth[reference(i)]);
  }
  double nees_of_motion(std::size_t i) const {
    return nees(error_of_motion(i), results[i].motion_covariance);
  }
  double nees_of_pose(std::size_t i) const {
    const Se3 T = truth.front().inverse() * truth[i];
    return nees(boxminus(results[i].T_world_camera, T), results[i].pose_covariance);
  }
};

// Changes the i-th frame before it is tracked. The truth is that of its stamp after the change.
using FrameChange = std::function<void(RgbdFrame& frame, std::size_t i)>;

inline TrackedSequence track_sequence(
    const SimulatorOptions& options, const Limits& limits, const Config& config, double stamp_sigma_s = 0,
    const FrameChange& change = [](RgbdFrame&, std::size_t) {}) {
  TrackedSequence tracked;
  std::unique_ptr<SimulatedCamera> camera;
  const Status created = SimulatedCamera::create(options, camera);
  EXPECT_TRUE(created.ok()) << created.message();
  if (!created.ok()) return tracked;
  CameraModel model = camera->model();
  model.stamp_sigma_s = stamp_sigma_s;
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, model, config, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  RgbdFrame frame;
  while (camera->next(frame).ok()) {
    change(frame, tracked.results.size());
    tracked.truth.push_back(camera->ground_truth(frame.stamp_ns));
    tracked.results.push_back(odometry.track(frame));
  }
  return tracked;
}

inline SimulatorOptions qvga_options(SceneName scene, int frames) {
  SimulatorOptions options = small_options(scene);
  options.camera.width = 320;
  options.camera.height = 240;
  options.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  options.frames = frames;
  return options;
}

// At 320×240; no frame may be lost.
inline TrackedSequence track_sequence(
    SceneName scene, int frames, const Config& config, double stamp_sigma_s = 0,
    const FrameChange& change = [](RgbdFrame&, std::size_t) {}) {
  TrackedSequence tracked =
      track_sequence(qvga_options(scene, frames), kTestLimits, config, stamp_sigma_s, change);
  for (const TrackResult& result : tracked.results)
    EXPECT_NE(result.state, TrackState::kLost) << result.status.message();
  return tracked;
}

inline void expect_same_poses(const TrackedSequence& a, const TrackedSequence& b) {
  ASSERT_EQ(a.results.size(), b.results.size());
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    EXPECT_EQ(a.results[i].T_world_camera.t, b.results[i].T_world_camera.t) << i;
    EXPECT_EQ(a.results[i].T_world_camera.R, b.results[i].T_world_camera.R) << i;
  }
}

}  // namespace plvo::test
