// SPDX-License-Identifier: Apache-2.0
// CameraModel::stamp_sigma_s: the reported pose of a frame whose stamp has an error. The estimate does not
// depend on stamps, so the poses must stay the same. The covariances must contain the motion of the camera
// between the exposure and the stamp.
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "plvo/odometry/stamp_error.hpp"
#include "tracked_sequence.hpp"

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

TEST(StampError, CovarianceOfAPoseIsThatOfTheMotionDuringIt) {
  const Se3 T = some_pose();
  const Matrix6 expected =
      by_differences([&](double error) { return T * moved(kVelocity, error).inverse(); });
  EXPECT_LT((stamp_covariance_of_pose(T, kVelocity, kSigma_s) - expected).norm(), 1e-6 * expected.norm());
}

TEST(StampError, CovarianceOfAMotionContainsBothStamps) {
  const Se3 T = some_pose();
  const Matrix6 expected =
      by_differences([&](double error) { return moved(kVelocity, error) * T; }) +
      by_differences([&](double error) { return T * moved(kReferenceVelocity, error).inverse(); });
  const Matrix6 C = stamp_covariance_of_motion(T, kVelocity, kReferenceVelocity, kSigma_s);
  EXPECT_LT((C - expected).norm(), 1e-6 * expected.norm());
}

// A sequence whose stamps have errors of kSigma_s, tracked by an odometry that is told of them, or not. The
// effect of the stamps is judged alone, without the common-mode error of a keyframe (kept_keyframe_test).
test::TrackedSequence track_with_stamps(double stamp_sigma_s) {
  constexpr int kFrames = 40;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Config config;
  config.noise.common_mode_share = 0;
  const auto change_stamp = [&](RgbdFrame& frame, std::size_t i) {
    if (i > 0) frame.stamp_ns += static_cast<std::int64_t>(1e9 * kSigma_s * normal(random));
  };
  return test::track_sequence(SceneName::kDesk, kFrames, config, stamp_sigma_s, change_stamp);
}

struct Means {
  double of_motion = 0, of_pose = 0;  // 6 if the covariance is true
};

Means mean_nees(const test::TrackedSequence& sequence) {
  Means means;
  double tracked = 0;
  for (std::size_t i = 0; i < sequence.results.size(); ++i) {
    if (sequence.results[i].state != TrackState::kTracking) continue;
    means.of_motion += sequence.nees_of_motion(i);
    means.of_pose += sequence.nees_of_pose(i);
    ++tracked;
  }
  return {means.of_motion / tracked, means.of_pose / tracked};
}

TEST(StampError, MakesCovariancesTrueAndDoesNotChangePoses) {
  const test::TrackedSequence told = track_with_stamps(kSigma_s), not_told = track_with_stamps(0);
  test::expect_same_poses(told, not_told);
  const Means with = mean_nees(told), without = mean_nees(not_told);
  const Means with_half = mean_nees(track_with_stamps(kSigma_s / 2));
  std::printf("NEES of motions and poses: told %.2f %.2f, told half %.2f %.2f, not told %.2f %.2f\n",
              with.of_motion, with.of_pose, with_half.of_motion, with_half.of_pose, without.of_motion,
              without.of_pose);
  // Narrow enough to tell half of the stamps' error from all of it.
  constexpr double kMostOfMotions = 4, kMostOfPoses = 5.5;
  EXPECT_GT(without.of_motion, 60);
  EXPECT_GT(with.of_motion, 2);
  EXPECT_LT(with.of_motion, kMostOfMotions);
  EXPECT_GT(with_half.of_motion, kMostOfMotions);
  EXPECT_GT(without.of_pose, 60);
  EXPECT_GT(with.of_pose, 2);
  EXPECT_LT(with.of_pose, kMostOfPoses);
  EXPECT_GT(with_half.of_pose, kMostOfPoses);
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
