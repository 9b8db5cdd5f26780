// SPDX-License-Identifier: Apache-2.0
// The references of a frame, and how its points are found there. By default these are the keyframe and a
// recent frame together, with registration; with the paper's settings the last frame alone, by descriptors.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr Limits kThreeReferences{
    .width = 160, .height = 120, .keypoints = 250, .segments = 64, .references = 3};
constexpr int kShownFrames = 10;

using Pixels = std::set<std::pair<float, float>>;

// The features and tracks of one frame.
struct Shown {
  TrackResult result;
  Pixels keypoints;
  std::vector<SegmentView> segments, reference_segments;
  std::vector<PointTrackView> point_tracks;
  std::size_t line_tracks = 0;
};

// Runs the odometry over every step-th frame of the sequence.
std::vector<Shown> run(const Config& config, int step = 1, int frames = kShownFrames) {
  ProceduralSequence sequence(kThreeReferences.width, kThreeReferences.height);
  std::vector<std::byte> memory(required_bytes(kThreeReferences));
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), config, kThreeReferences);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<Shown> all;
  for (int i = 0; i < frames; ++i) {
    Shown shown;
    shown.result = odometry.track(sequence.render(step * i));
    EXPECT_NE(shown.result.state, TrackState::kLost) << shown.result.status.message();
    const FeatureView view = odometry.features();
    for (const Keypoint& keypoint : view.keypoints) shown.keypoints.insert({keypoint.u, keypoint.v});
    shown.segments.assign(view.segments.begin(), view.segments.end());
    shown.reference_segments.assign(view.reference_segments.begin(), view.reference_segments.end());
    shown.point_tracks.assign(view.point_tracks.begin(), view.point_tracks.end());
    shown.line_tracks = view.line_tracks.size();
    all.push_back(shown);
  }
  return all;
}

int count(const std::vector<PointTrackView>& tracks, const Pixels& pixels, bool in_reference) {
  return static_cast<int>(std::count_if(tracks.begin(), tracks.end(), [&](const PointTrackView& track) {
    return pixels.count(in_reference ? std::pair(track.u_reference, track.v_reference)
                                     : std::pair(track.u, track.v)) > 0;
  }));
}

bool same_places(const std::vector<SegmentView>& a, const std::vector<SegmentView>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const SegmentView& x, const SegmentView& y) {
    return x.a_u == y.a_u && x.a_v == y.a_v && x.b_u == y.b_u && x.b_v == y.b_v;
  });
}

// The last frame before frame i in which points were detected.
std::size_t recent_to(const std::vector<Shown>& all, std::size_t i) {
  while (i-- > 0)
    if (!all[i].keypoints.empty()) break;
  return i;
}

// Expects that the tracks and reference segments of frame i belong to the recent frame.
void expect_shows_the_recent_frame(const std::vector<Shown>& all, std::size_t i) {
  const Shown& now = all[i];
  const Shown& recent = all[recent_to(all, i)];
  ASSERT_GT(now.point_tracks.size(), 10u) << i;
  EXPECT_LE(i - recent_to(all, i), 3u) << i;
  EXPECT_EQ(count(now.point_tracks, recent.keypoints, true), static_cast<int>(now.point_tracks.size())) << i;
  EXPECT_TRUE(same_places(now.reference_segments, recent.segments)) << i;
  EXPECT_EQ(now.result.points.with_depth, static_cast<int>(all[recent_to(all, i + 1)].keypoints.size())) << i;
}

TEST(References, DetectsPointsOnlyInFramesThatAreMatchedLater) {
  Config config;
  const std::vector<Shown> some = run(config);
  config.references.policy = ReferencePolicy::kPreviousFrame;
  const std::vector<Shown> all = run(config);
  int searched = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_FALSE(all[i].keypoints.empty()) << i;
    EXPECT_EQ(recent_to(all, i), i - 1);
    searched += some[i].keypoints.empty() ? 0 : 1;
    EXPECT_LE(i - recent_to(some, i), 3u);
    const Se3 truth = ProceduralSequence::T_world_camera(0).inverse() *
                      ProceduralSequence::T_world_camera(static_cast<int>(i));
    const Vector6 error = boxminus(some[i].result.T_world_camera, truth);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 0.01) << i;
  }
  EXPECT_LE(searched, kShownFrames * 2 / 3);
  EXPECT_GE(searched, kShownFrames / 3);
}

TEST(References, UsesTheKeyframeAndARecentFrameByDefault) {
  const std::vector<Shown> all = run(Config{});
  std::size_t keyframe = 0;
  int with_both = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const TrackResult& result = all[i].result;
    ASSERT_EQ(result.state, TrackState::kTracking);
    // The keyframe stays, or the previous frame becomes the keyframe.
    if (result.reference_stamp_ns != all[keyframe].result.stamp_ns) keyframe = i - 1;
    EXPECT_EQ(result.reference_stamp_ns, all[keyframe].result.stamp_ns) << i;
    expect_shows_the_recent_frame(all, i);
    // Counts include all references; the view shows only the last one.
    const int shown = static_cast<int>(all[i].point_tracks.size());
    if (keyframe == i - 1) {
      EXPECT_EQ(result.points.matched, shown) << i;
      EXPECT_EQ(result.lines.matched, static_cast<int>(all[i].line_tracks)) << i;
      continue;
    }
    ++with_both;
    EXPECT_GT(result.points.matched, shown + 10) << i;
    EXPECT_LT(count(all[i].point_tracks, all[keyframe].keypoints, true), shown) << i;
    // The motion is relative to the keyframe.
    const Se3 expected = result.T_world_camera.inverse() * all[keyframe].result.T_world_camera;
    EXPECT_LT(boxminus(result.T_camera_reference, expected).cwiseAbs().maxCoeff(), 1e-9) << i;
  }
  EXPECT_GE(with_both, 3) << "a keyframe must be kept for some frames";
}

// Three references have more than this many times the matches of the last frame; two have fewer.
constexpr double kOfThree = 2.4;

// A configuration that changes the keyframe every few frames.
Config window_config() {
  Config config;
  config.references.policy = ReferencePolicy::kWindow;
  config.references.keyframe_inlier_ratio = 0.6;
  return config;
}

TEST(References, AWindowStillMatchesThePreviousKeyframe) {
  const std::vector<Shown> window = run(window_config(), 4);
  int after_a_change = 0, with_three = 0;
  for (std::size_t i = 2; i < window.size(); ++i) {
    const TrackResult& result = window[i].result;
    ASSERT_EQ(result.state, TrackState::kTracking);
    expect_shows_the_recent_frame(window, i);
    const Se3 expected = [&] {
      std::size_t k = 0;
      while (window[k].result.stamp_ns != result.reference_stamp_ns) ++k;
      return result.T_world_camera.inverse() * window[k].result.T_world_camera;
    }();
    EXPECT_LT(boxminus(result.T_camera_reference, expected).cwiseAbs().maxCoeff(), 1e-9) << i;
    const int shown = static_cast<int>(window[i].point_tracks.size());
    if (result.reference_stamp_ns == window[i - 1].result.stamp_ns) {
      // The keyframe is the last frame, so the other matches are with the previous keyframe.
      ++after_a_change;
      EXPECT_GT(result.points.matched, shown + 10) << i;
    } else if (result.reference_stamp_ns != window[0].result.stamp_ns) {
      with_three += result.points.matched > kOfThree * shown ? 1 : 0;
    }
  }
  EXPECT_GE(after_a_change, 2);
  EXPECT_GE(with_three, 1);
}

// Frame 3 becomes the keyframe, so frame 4 is matched with the older one too, and frame 5 only if the camera
// is slow enough for a fifth of the older one's features to be inliers.
TEST(References, DropsAnOlderKeyframeWithFewInliers) {
  for (const int step : {10, 12}) {
    Config config;
    config.references.keyframe_inlier_ratio = 0.4;
    const std::vector<Shown> two = run(config, step, 6);
    config.references.policy = ReferencePolicy::kWindow;
    const std::vector<Shown> three = run(config, step, 6);
    const auto with_older = [&](std::size_t i) {
      EXPECT_EQ(three[i].result.reference_stamp_ns, three[3].result.stamp_ns) << step << ", " << i;
      EXPECT_EQ(two[i].result.reference_stamp_ns, three[3].result.stamp_ns) << step << ", " << i;
      return three[i].result.points.matched - two[i].result.points.matched;
    };
    EXPECT_GT(with_older(4), 20) << step;
    if (step == 10)
      EXPECT_GT(with_older(5), 20);
    else
      EXPECT_LT(with_older(5), 5);
  }
}

// set_pose() keeps the relative poses of the frames in a window: directly after a change of keyframes (frame
// 4), and when all three frames differ (frame 6).
TEST(References, SetPoseKeepsTheRelativePosesOfAWindow) {
  for (const int moved : {4, 6}) {
    ProceduralSequence sequence(kThreeReferences.width, kThreeReferences.height);
    std::vector<std::byte> memory(required_bytes(kThreeReferences)),
        other_memory(required_bytes(kThreeReferences));
    Odometry odometry, other;
    ASSERT_TRUE(odometry.init(memory, sequence.camera(), window_config(), kThreeReferences).ok());
    ASSERT_TRUE(other.init(other_memory, sequence.camera(), window_config(), kThreeReferences).ok());
    const Se3 T_other_world = boxplus(Se3{}, (Vector6() << 3, -2, 1, 0.5, 1.2, -0.7).finished());
    for (int i = 0; i < kShownFrames; ++i) {
      const RgbdFrame frame = sequence.render(4 * i);
      const TrackResult a = odometry.track(frame), b = other.track(frame);
      ASSERT_EQ(a.state, i == 0 ? TrackState::kInitialising : TrackState::kTracking) << i;
      ASSERT_EQ(b.state, a.state) << i;
      EXPECT_EQ(b.reference_stamp_ns, a.reference_stamp_ns) << i;
      EXPECT_EQ(b.points.matched, a.points.matched) << i;
      const Se3 expected = i > moved ? T_other_world * a.T_world_camera : a.T_world_camera;
      EXPECT_LT(boxminus(b.T_world_camera, expected).cwiseAbs().maxCoeff(), 1e-6) << i;
      if (i != moved) continue;
      const Status status = other.set_pose(T_other_world * b.T_world_camera, b.pose_covariance);
      ASSERT_TRUE(status.ok()) << status.message();
    }
  }
}

TEST(References, RefusesAPolicyWithMoreReferencesThanLimits) {
  Limits limits = kThreeReferences;
  limits.references = 2;
  Config config;
  config.references.policy = ReferencePolicy::kWindow;
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, ProceduralSequence(160, 120).camera(), config, limits);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_STREQ(status.message(), "config: references.policy needs Limits::references = 3");
}

TEST(References, ShowsTheTracksOfASingleKeyframe) {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  config.references.keyframe_inlier_ratio = 0;
  const std::vector<Shown> all = run(config);
  for (std::size_t i = 1; i < all.size(); ++i) {
    const int shown = static_cast<int>(all[i].point_tracks.size());
    EXPECT_EQ(all[i].result.reference_stamp_ns, all[0].result.stamp_ns);
    EXPECT_EQ(all[i].result.points.matched, shown);
    EXPECT_EQ(count(all[i].point_tracks, all[0].keypoints, true), shown) << i;
  }
}

TEST(References, ThePaperUsesTheLastFrameAndNoRegistration) {
  const std::vector<Shown> all = run(Config::paper());
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_EQ(all[i].result.reference_stamp_ns, all[i - 1].result.stamp_ns) << i;
    EXPECT_EQ(recent_to(all, i), i - 1);
    expect_shows_the_recent_frame(all, i);
    const int shown = static_cast<int>(all[i].point_tracks.size());
    EXPECT_EQ(all[i].result.points.matched, shown) << i;
    // Without registration, a point is where the detector put it.
    EXPECT_EQ(count(all[i].point_tracks, all[i].keypoints, false), shown) << i;
  }
  // With registration hardly any point is, so the test can distinguish the two.
  const std::vector<Shown> registered = run(Config{});
  for (std::size_t i = 1; i < registered.size(); ++i)
    EXPECT_LT(count(registered[i].point_tracks, registered[i].keypoints, false),
              static_cast<int>(registered[i].point_tracks.size()) / 4)
        << i;
}

}  // namespace
}  // namespace plvo
