// SPDX-License-Identifier: Apache-2.0
// Limits for one reference: the same bits as with more, in less memory, for any sequence of frames. Policies
// with more references are refused.
#include <gtest/gtest.h>

#include <vector>

#include "fingerprint.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

Limits with_references(Limits limits, int references) {
  limits.references = references;
  return limits;
}

// One hash per frame, of its result, its features and their tracks, as the public API shows them.
std::vector<std::uint64_t> track(Config config, const Limits& limits) {
  config.references.max_lost_s = 0.06;
  ProceduralSequence sequence(limits.width, limits.height);
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), config, limits);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<std::uint64_t> prints;
  int tracked = 0, lost = 0;
  for (int i = 0; i < 24; ++i) {
    // A short loss, and then one that is so long that tracking restarts.
    const bool dark = i == 6 || i == 7 || (i >= 12 && i < 16);
    const TrackResult result = odometry.track(dark ? sequence.render_dark(i) : sequence.render(i));
    tracked += result.state == TrackState::kTracking ? 1 : 0;
    lost += result.state == TrackState::kLost ? 1 : 0;
    Fingerprint print;
    print.add(static_cast<int>(result.state));
    print.add(result.T_world_camera.R);
    print.add(result.T_world_camera.t);
    print.add(result.pose_covariance);
    const FeatureView view = odometry.features();
    for (const Keypoint& keypoint : view.keypoints) print.add(static_cast<double>(keypoint.u));
    for (const SegmentView& segment : view.segments) print.add(static_cast<double>(segment.a_u));
    for (const SegmentView& segment : view.reference_segments) print.add(static_cast<double>(segment.a_u));
    for (const PointTrackView& track : view.point_tracks) print.add(static_cast<double>(track.u_reference));
    prints.push_back(print.value());
  }
  EXPECT_GE(tracked, 14);
  EXPECT_GE(lost, 5);
  return prints;
}

Config keyframe_only() {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  return config;
}

TEST(OneReference, GivesTheSameBitsInLessMemory) {
  constexpr Limits kOne = Limits::tiny();
  static_assert(kOne.references == 1);
  const Limits two = with_references(kOne, 2);
  EXPECT_LT(required_bytes(kOne), required_bytes(two));
  for (const Config& config : {keyframe_only(), Config::paper()})
    EXPECT_EQ(track(config, kOne), track(config, two));
}

TEST(OneReference, AllowsAKeyframeThatChangesWithEveryFrame) {
  Config config = keyframe_only();
  config.references.keyframe_inlier_ratio = 1;
  EXPECT_EQ(track(config, Limits::tiny()), track(config, with_references(Limits::tiny(), 2)));
}

TEST(OneReference, RefusesAPolicyWithTwoReferences) {
  constexpr Limits kLimits = Limits::tiny();
  std::vector<std::byte> memory(required_bytes(kLimits));
  Odometry odometry;
  const CameraModel camera{320, 240, {260, 260, 160, 120}, {}};
  const Status status = odometry.init(memory, camera, Config{}, kLimits);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find("Limits::references"), std::string::npos) << status.message();
  EXPECT_TRUE(odometry.init(memory, camera, Config::tiny(), kLimits).ok());
  EXPECT_FALSE(with_references(kLimits, 0).validate().ok());
  EXPECT_FALSE(with_references(kLimits, 4).validate().ok());
}

}  // namespace
}  // namespace plvo
