// SPDX-License-Identifier: Apache-2.0
// CameraModel::stamp_sigma_s: what is reported of a pose whose stamp errs. The estimate does not know of
// stamps, so that the poses must stay as they are, and the covariances must hold what the camera moves
// between the exposure and the stamp.
#include <cmath>
#include <random>
#include <vector>

#include "plvo/math/cholesky.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

const Vector6 kVelocity = (Vector6() << 0.3, -0.2, 0.5, 0.4, -0.7, 0.2).finished();
const Vector6 kReferenceVelocity = (Vector6() << -0.1, 0.4, 0.2, -0.3, 0.5, 0.6).finished();
constexpr double kSigma_s = 0.004;

Se3 some_pose() { return boxplus(Se3{}, (Vector6() << 0.4, -1.2, 2.1, 0.5, 0.3, -0.8).finished()); }

// X_later = T X_now, of a camera with this velocity.
Se3 moved(const Vector6& velocity, double seconds) { return boxplus(Se3{}, seconds * velocity); }

// The covariance of f(ε) ⊞-perturbed about f(0), ε one stamp's error, from differences.
template <typename Function>
Matrix6 by_differences(const Function& f) {
  constexpr double kStep_s = 1e-6;
  const Vector6 rate = boxminus(f(kStep_s), f(-kStep_s)) / (2 * kStep_s);
  return kSigma_s * kSigma_s * rate * rate.transpose();
}

TEST(StampError, OfAPoseIsWhatTheCameraMovesMeanwhile) {
  const Se3 T = some_pose();
  const Matrix6 expected =
      by_differences([&](double error) { return T * moved(kVelocity, error).inverse(); });
  EXPECT_LT((stamp_covariance_of_pose(T, kVelocity, kSigma_s) - expected).norm(), 1e-6 * expected.norm());
}

TEST(StampError, OfAMotionIsThatOfBothItsEnds) {
  const Se3 T = some_pose();
  const Matrix6 expected =
      by_differences([&](double error) { return moved(kVelocity, error) * T; }) +
      by_differences([&](double error) { return T * moved(kReferenceVelocity, error).inverse(); });
  const Matrix6 C = stamp_covariance_of_motion(T, kVelocity, kReferenceVelocity, kSigma_s);
  EXPECT_LT((C - expected).norm(), 1e-6 * expected.norm());
}

struct Tracked {
  std::vector<TrackResult> results;
  double nees_motion = 0,
         nees_pose = 0;  // means, against the truth at the stamps; 6 if the covariance is true
};

double nees(const Vector6& error, const Matrix6& covariance) {
  Cholesky<6> cholesky;
  EXPECT_TRUE(cholesky.factor(covariance));
  return error.dot(cholesky.solve(error));
}

// A walk whose stamps err by kSigma_s, tracked by an odometry that is told so, or not.
Tracked track_walk(double stamp_sigma_s) {
  constexpr int kFrames = 40;
  SimulatorOptions options = test::small_options(SceneName::kDesk);
  options.camera.width = 320;
  options.camera.height = 240;
  options.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  options.frames = kFrames;
  std::unique_ptr<SimulatedCamera> camera;
  EXPECT_TRUE(SimulatedCamera::create(options, camera).ok());
  CameraModel model = camera->model();
  model.stamp_sigma_s = stamp_sigma_s;
  const Limits limits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, model, Config{}, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Tracked tracked;
  std::vector<Se3> truth;
  RgbdFrame frame;
  while (camera->next(frame).ok()) {
    // The world is where the first frame was exposed, whatever its stamp: that one is right.
    if (!truth.empty()) frame.stamp_ns += static_cast<std::int64_t>(1e9 * kSigma_s * normal(random));
    truth.push_back(camera->ground_truth(frame.stamp_ns));
    const TrackResult result = odometry.track(frame);
    EXPECT_NE(result.state, TrackState::kLost) << result.status.message();
    tracked.results.push_back(result);
    if (result.state != TrackState::kTracking) continue;
    std::size_t reference = 0;
    while (tracked.results[reference].stamp_ns != result.reference_stamp_ns) ++reference;
    const Vector6 of_motion = boxminus(result.T_camera_reference, truth.back().inverse() * truth[reference]);
    tracked.nees_motion += nees(of_motion, result.motion_covariance) / (kFrames - 1);
    const Vector6 of_pose = boxminus(result.T_world_camera, truth.front().inverse() * truth.back());
    tracked.nees_pose += nees(of_pose, result.pose_covariance) / (kFrames - 1);
  }
  return tracked;
}

TEST(StampError, MakesCovariancesTrueAndLeavesThePosesAlone) {
  const Tracked told = track_walk(kSigma_s), not_told = track_walk(0);
  ASSERT_EQ(told.results.size(), not_told.results.size());
  for (std::size_t i = 0; i < told.results.size(); ++i) {
    EXPECT_EQ(told.results[i].T_world_camera.t, not_told.results[i].T_world_camera.t) << i;
    EXPECT_EQ(told.results[i].T_world_camera.R, not_told.results[i].T_world_camera.R) << i;
  }
  EXPECT_GT(not_told.nees_motion, 60);
  EXPECT_GT(told.nees_motion, 2);
  EXPECT_LT(told.nees_motion, 10);
  EXPECT_GT(not_told.nees_pose, 60);
  EXPECT_GT(told.nees_pose, 2);
  EXPECT_LT(told.nees_pose, 10);
}

TEST(StampError, StaysWithTheLastGoodPose) {
  SimulatorOptions options = test::small_options(SceneName::kDesk);
  options.frames = 5;
  options.covered_first = 3;
  options.covered_end = 5;
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
  CameraModel model = camera->model();
  model.stamp_sigma_s = kSigma_s;
  const Limits limits{.width = 160, .height = 120, .keypoints = 250, .segments = 64};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, model, Config{}, limits).ok());
  RgbdFrame frame;
  TrackResult last_good, result;
  while (camera->next(frame).ok()) {
    if (result.state != TrackState::kLost) last_good = result;
    result = odometry.track(frame);
  }
  ASSERT_EQ(last_good.state, TrackState::kTracking) << last_good.status.message();
  ASSERT_EQ(result.state, TrackState::kLost);
  EXPECT_LT((result.pose_covariance - last_good.pose_covariance).norm(),
            1e-9 * result.pose_covariance.norm());
}

TEST(StampError, OfMoreThanATenthOfASecondIsRefused) {
  CameraModel camera;
  camera.stamp_sigma_s = 0.1;
  EXPECT_TRUE(camera.validate().ok());
  for (const double wrong : {-1e-9, 0.11, std::nan("")}) {
    camera.stamp_sigma_s = wrong;
    EXPECT_EQ(camera.validate().code(), StatusCode::kInvalidArgument) << wrong;
  }
}

}  // namespace
}  // namespace plvo
