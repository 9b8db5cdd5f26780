// SPDX-License-Identifier: Apache-2.0
// After a loss, lost frames are matched with each other. Tracking restarts with a covariance that includes
// the unobserved motion, and the pose is corrected when an old view comes back. References are given up by
// time, not by frames.
#include <gtest/gtest.h>

#include <string>

#include "procedural_camera.hpp"

namespace plvo {
namespace {

using test::ProceduralCamera;

// Takes five frames a second.
class SlowCamera : public ProceduralCamera {
 public:
  explicit SlowCamera(int kept_keyframes) : ProceduralCamera(kept_keyframes, {}, 200'000'000) {}
};

double normalised_error(const TrackResult& result, int view) {
  const Vector6 error = test::pose_error(result, view);
  return error.dot(result.pose_covariance.ldlt().solve(error));
}

constexpr int kLeft = 6;        // the last view before the jump
constexpr int kElsewhere = 60;  // a view that shares nothing with those before

TEST(Loss, ALostFrameIsMatchedWithTheLostFrameBefore) {
  SlowCamera camera(1);
  TrackResult before;
  for (int view = 0; view <= kLeft; ++view) before = camera.see(view);
  ASSERT_EQ(before.state, TrackState::kTracking);
  camera.pause(9);  // so that the camera may have come that far
  EXPECT_EQ(camera.see(kElsewhere).state, TrackState::kLost);
  TrackResult result = camera.see(kElsewhere + 1);
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_NE(std::string(result.status.message()).find("tracking restarts"), std::string::npos);
  EXPECT_TRUE(result.restarted);
  const double unobserved_m = 0.5 * 2.0;  // ReferenceConfig::process_noise_m_per_s
  EXPECT_GE(result.pose_covariance(0, 0), unobserved_m * unobserved_m);
  bool relocalised = false;
  for (int view = kElsewhere; view >= kLeft && !relocalised; --view) {
    result = camera.see(view);
    EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
    EXPECT_EQ(result.status.message()[0], '\0');
    EXPECT_FALSE(result.restarted);
    relocalised = result.relocalised;
  }
  EXPECT_TRUE(relocalised);
  EXPECT_LT(result.pose_covariance(0, 0), 1e-3);
}

TEST(Loss, TheCovarianceAfterARestartContainsACameraThatKeptItsVelocity) {
  constexpr int kViewsPerFrame = 4;  // fast, and yet tracked
  SlowCamera camera(1);
  int view = 0;
  TrackResult before;
  for (; view <= 5 * kViewsPerFrame; view += kViewsPerFrame) before = camera.see(view);
  ASSERT_EQ(before.state, TrackState::kTracking) << before.status.message();
  view -= kViewsPerFrame;
  EXPECT_EQ(camera.see(kElsewhere).state, TrackState::kLost);
  const TrackResult result = camera.see(kElsewhere + 1);
  ASSERT_EQ(result.state, TrackState::kTracking) << result.status.message();
  const Vector6 going_on = boxminus(ProceduralSequence::T_world_camera(view),
                                    ProceduralSequence::T_world_camera(view - kViewsPerFrame));
  const Matrix6 process_noise = 0.1 * 0.1 * Matrix6::Identity();  // half of a metre and of a radian a second
  EXPECT_GT(result.pose_covariance.trace(), process_noise.trace() + 0.5 * going_on.squaredNorm());
}

TEST(Loss, WithoutMemoryTheReferencesAreGivenUpAfterHalfASecond) {
  SlowCamera camera(0);
  for (int view = 0; view <= kLeft; ++view) (void)camera.see(view);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera.see(kElsewhere + i).state, TrackState::kLost) << i;
  const TrackResult start = camera.see(kElsewhere + 3);
  EXPECT_EQ(start.state, TrackState::kInitialising);
  EXPECT_TRUE(start.restarted);
  EXPECT_EQ(start.world, 0U) << "the last good pose is in the same world";
  const TrackResult result = camera.see(kElsewhere + 4);
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_FALSE(result.restarted);
}

TEST(Loss, ASingleLostFrameChangesNothing) {
  SlowCamera camera(1);
  TrackResult result;
  for (int view = 0; view <= kLeft; ++view) result = camera.see(view);
  const std::int64_t reference = result.reference_stamp_ns;
  EXPECT_EQ(camera.see(kElsewhere).state, TrackState::kLost);
  result = camera.see(kLeft + 1);
  EXPECT_EQ(result.state, TrackState::kTracking) << result.status.message();
  EXPECT_EQ(result.reference_stamp_ns, reference);
  EXPECT_LT(normalised_error(result, kLeft + 1), 25);
}

}  // namespace
}  // namespace plvo
