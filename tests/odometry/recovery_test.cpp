// SPDX-License-Identifier: Apache-2.0
// Relocalisation at a view from before a loss: at once if the lens is uncovered at the same view, later if
// tracking has restarted elsewhere. A different place that looks alike is rejected.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "procedural_camera.hpp"

namespace plvo {
namespace {

using test::pose_error;
using test::ProceduralCamera;

constexpr int kDark = ProceduralCamera::kDark;

// Thirty frames a second.
class CameraWithLosses : public ProceduralCamera {
 public:
  explicit CameraWithLosses(int kept_keyframes, const Config& config = quick_to_give_up())
      : ProceduralCamera(kept_keyframes, config, 33'333'333) {}
  static Config quick_to_give_up() {
    Config config;
    config.references.max_lost_s = 0.06;
    return config;
  }
};

double distance_to_truth(const TrackResult& result, int view) {
  return pose_error(result, view).head<3>().norm();
}

constexpr int kOut = 6;    // the last view before the loss
constexpr int kAway = 50;  // the camera's position after the loss

TEST(Recovery, ResumesAtTheKeyframeAfterACoveredLens) {
  for (const int kept : {0, 1}) {
    CameraWithLosses camera(kept);
    TrackResult before;
    for (int view = 0; view <= kOut; ++view) before = camera.see(view);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(camera.see(kDark).state, TrackState::kLost);
    // Uncovered, five views later.
    const TrackResult after = camera.see(kOut + 5);
    EXPECT_EQ(after.relocalised, kept > 0);
    EXPECT_EQ(after.state, kept > 0 ? TrackState::kTracking : TrackState::kInitialising);
    const double error = distance_to_truth(after, kOut + 5);
    std::printf("%d kept: %.1f mm beside the truth\n", kept, 1e3 * error);
    if (kept > 0) {
      EXPECT_LT(error, 0.015);
      EXPECT_LT(after.pose_covariance(0, 0), 1e-4) << "without process noise";
    } else {
      EXPECT_GT(error, 0.03) << "without relocalisation the error is large";
    }
    const TrackResult next = camera.see(kOut + 6);
    EXPECT_EQ(next.state, TrackState::kTracking) << next.status.message();
    EXPECT_FALSE(next.relocalised);
  }
}

TEST(Recovery, RestoresTheOldPoseAtAKeptKeyframe) {
  for (const int kept : {0, 1, 2}) {
    CameraWithLosses camera(kept);
    for (int view = 0; view <= kOut; ++view) (void)camera.see(view);
    for (int i = 0; i < 12; ++i) (void)camera.see(kDark);
    // Elsewhere: a restart at a pose whose error is the unobserved motion.
    TrackResult result = camera.see(kAway);
    EXPECT_EQ(result.state, TrackState::kInitialising);
    EXPECT_FALSE(result.relocalised);
    EXPECT_EQ(result.ransac_iterations > 0, kept > 0) << "the kept keyframe was looked for";
    EXPECT_EQ(result.points.matched + result.lines.matched, 0) << "and not recognised";
    EXPECT_GT(distance_to_truth(result, kAway), 0.2);
    int returns = 0;
    for (int view = kAway - 1; view >= 0; --view) {
      const double sigma = std::sqrt(result.pose_covariance(0, 0));
      result = camera.see(view);
      ASSERT_EQ(result.state, TrackState::kTracking) << result.status.message();
      if (result.relocalised) {
        ++returns;
        std::printf("%d kept: back at view %d, SD %.0f mm before, %.2f mm after\n", kept, view, 1e3 * sigma,
                    1e3 * std::sqrt(result.pose_covariance(0, 0)));
        const double sigma_now = std::sqrt(result.pose_covariance.block<3, 3>(0, 0).trace());
        EXPECT_LT(distance_to_truth(result, view), 3 * sigma_now);
        EXPECT_LT(sigma_now, 0.02);
        EXPECT_GT(sigma, 0.1);
      }
    }
    EXPECT_EQ(returns, kept > 0 ? 1 : 0) << "a keyframe is relocalised only once";
    std::printf("%d kept: %.1f mm beside the truth at the end\n", kept, 1e3 * distance_to_truth(result, 0));
    if (kept > 0)
      EXPECT_LT(distance_to_truth(result, 0), 0.05);
    else
      EXPECT_GT(distance_to_truth(result, 0), 0.4);
  }
}

TEST(Recovery, RejectsASimilarViewBeyondTheUncertainty) {
  // The process noise allows at most a millimetre per second of unobserved motion. So a similar view from a
  // few centimetres away must be another place.
  Config config = CameraWithLosses::quick_to_give_up();
  config.references.process_noise_m_per_s = config.references.process_noise_rad_per_s = 1e-3;
  CameraWithLosses camera(1, config);
  TrackResult before;
  for (int view = 0; view <= kOut; ++view) before = camera.see(view);
  for (int i = 0; i < 10; ++i) (void)camera.see(kDark);
  const TrackResult after = camera.see(kOut + 5);
  EXPECT_FALSE(after.relocalised);
  EXPECT_EQ(after.state, TrackState::kInitialising);
  EXPECT_EQ(after.T_world_camera.t, before.T_world_camera.t);
}

// The nearer of two views shows less of the keyframe. Right after the loss it is tracked all the same. A
// minute later the camera may be anywhere, and a part of the keyframe's view may be that of another place.
TEST(Recovery, AfterALongGapAPartOfTheOldViewIsNotEnough) {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  int refused = 0;
  for (int away = 4; away <= 40; away += 4) {
    std::array<TrackResult, 2> back;
    int of_keyframe = 0;
    for (const bool is_late : {false, true}) {
      ProceduralCamera camera(1, config, 33'333'333);
      for (int view = 0; view <= kOut; ++view) (void)camera.see(view);
      of_keyframe = camera.odometry.keyframe().features->count_3d();
      if (is_late) camera.pause(1800);
      (void)camera.see(kDark);
      back[is_late ? 1 : 0] = camera.see(kOut + away);
    }
    const auto& [early, late] = back;
    const double share = (early.points.inliers + early.lines.inliers) / static_cast<double>(of_keyframe);
    std::printf("%d views on: %s, %.2f of the keyframe; late: %s\n", away, to_string(early.state), share,
                to_string(late.state));
    if (early.state != TrackState::kTracking) continue;
    // Registration finds more or less, so not at the very threshold.
    if (share > config.references.keyframe_inlier_ratio + 0.1) {
      EXPECT_EQ(late.state, TrackState::kTracking) << away;
      EXPECT_LT(distance_to_truth(late, kOut + away), 0.03) << away;
    } else if (share < config.references.keyframe_inlier_ratio - 0.05) {
      EXPECT_NE(late.state, TrackState::kTracking) << away;
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(Recovery, SetPoseDropsTheKeptKeyframes) {
  CameraWithLosses camera(1);
  for (int view = 0; view <= kOut; ++view) (void)camera.see(view);
  for (int i = 0; i < 10; ++i) (void)camera.see(kDark);
  ASSERT_TRUE(camera.odometry.set_pose(Se3(), Matrix6::Identity()).ok());
  EXPECT_FALSE(camera.see(kOut).relocalised);
}

TEST(KeptKeyframes, ReplacesTheOldest) {
  KeptKeyframes kept;
  kept.init(2);
  kept.keep(4);
  kept.keep(1);
  kept.keep(1);
  EXPECT_TRUE(kept.holds(4));
  kept.keep(3);
  EXPECT_FALSE(kept.holds(4));
  EXPECT_TRUE(kept.holds(1));
  EXPECT_EQ(kept.latest(), 3);
  const int first = kept.next();
  EXPECT_NE(kept.next(), first);
  EXPECT_EQ(kept.next(), first);
  kept.drop(1);
  EXPECT_EQ(kept.next(), 3);
  kept.drop(3);
  EXPECT_TRUE(kept.empty());
  kept.init(0);
  kept.keep(7);
  EXPECT_TRUE(kept.empty()) << "the capacity is zero";
}

}  // namespace
}  // namespace plvo
