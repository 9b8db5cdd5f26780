// SPDX-License-Identifier: Apache-2.0
// The map beside the odometry of `plvo run` and `plvo live`: a session may last for hours, so nothing is
// allocated for a frame, and the poses of frames survive the keyframes that they hang on.
#include "plvo/cli/map/session_map.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "procedural_sequence.hpp"
#include "temporary_folder.hpp"

namespace plvo::cli {
namespace {

constexpr int kWidthOfSession = 160, kHeightOfSession = 120;

// Moves there and back in the procedural room, with a map of the fewest keyframes.
class Session {
 public:
  explicit Session(const MapOptions& options) {
    const Limits limits{kWidthOfSession, kHeightOfSession, 250, 64, 2, 1, 0};
    memory_.resize(required_bytes(limits));
    EXPECT_TRUE(odometry_.init(memory_, sequence_.camera(), Config(), limits).ok());
    const Status status = map.init(options, sequence_.camera(), Config(), false);
    EXPECT_TRUE(status.ok()) << status.message();
  }
  void track_there_and_back() {
    for (int round = 0; round < 3; ++round) {
      for (int view = 0; view < kFramesOneWay; ++view) see(view);
      for (int view = kFramesOneWay; view > 0; --view) see(view);
    }
    map.finish();
  }
  // A frame, and its pose in the map over the keyframes with which its keyframe was merged, one after the
  // other.
  struct Seen {
    std::int64_t stamp_ns = 0;
    std::uint32_t keyframe = 0;
    Se3 T_keyframe_camera;
  };
  std::optional<Se3> T_map_camera(const Seen& frame) const {
    Se3 T = frame.T_keyframe_camera;
    std::uint32_t id = frame.keyframe;
    for (; removed_.count(id) != 0; id = removed_.at(id).first) T = removed_.at(id).second * T;
    const std::optional<Se3> T_map_keyframe = map.map().keyframe_pose(id);
    return T_map_keyframe ? std::optional<Se3>(*T_map_keyframe * T) : std::nullopt;
  }

  SessionMap map;
  std::int64_t allocations = 0;
  std::vector<Seen> frames;  // that had a pose

 private:
  static constexpr int kFramesOneWay = 100;

  void see(int view) {
    RgbdFrame frame = sequence_.render(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(static_cast<int>(record_.number++));
    record_.result = odometry_.track(frame);
    AllocationGuard guard;
    map.add(odometry_, record_);
    allocations += guard.calls();
    guard.disarm();
    const MapResult& in_map = *map.latest();
    if (in_map.removed != 0) removed_[in_map.removed] = {in_map.removed_into, in_map.T_into_removed};
    if (record_.has_pose()) frames.push_back({frame.stamp_ns, in_map.keyframe, in_map.T_keyframe_camera});
  }

  std::vector<std::byte> memory_;
  ProceduralSequence sequence_{kWidthOfSession, kHeightOfSession};
  Odometry odometry_;
  FrameRecord record_;
  std::map<std::uint32_t, std::pair<std::uint32_t, Se3>> removed_;
};

MapOptions least_map() {
  MapOptions options;
  options.keyframes = MapLimits::kLeastKeyframes;
  options.trajectory = "-";
  return options;
}

TEST(SessionMap, AllocatesNothingForAFrame) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "a sanitizer has its own malloc";
  Session session(least_map());
  session.track_there_and_back();
  EXPECT_GT(session.map.map().counts().removed, 0);
  EXPECT_EQ(session.allocations, 0);
}

TEST(SessionMap, PosesOutlastTheirKeyframes) {
  Session session(least_map());
  session.track_there_and_back();
  EXPECT_GT(session.map.map().counts().removed, 4);
  std::size_t at = 0;
  const Status status = session.map.poses([&](std::int64_t stamp_ns, const Se3& T_map_camera) {
    while (session.frames.at(at).stamp_ns < stamp_ns)
      EXPECT_FALSE(session.T_map_camera(session.frames[at++]));
    EXPECT_EQ(session.frames[at].stamp_ns, stamp_ns);
    const std::optional<Se3> expected = session.T_map_camera(session.frames[at++]);
    EXPECT_TRUE(expected && boxminus(T_map_camera, *expected).norm() < 1e-9) << at;
    return Status();
  });
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(at, session.frames.size());
}

TEST(SessionMap, SaysWhyThePosesCannotBeKept) {
  const test::TemporaryFolder folder;
  const char* before = std::getenv("TMPDIR");
  const std::optional<std::string> kept =
      before != nullptr ? std::optional<std::string>(before) : std::nullopt;
  ::setenv("TMPDIR", (folder / "none").c_str(), 1);
  FrameAnchors anchors;
  const Status status = anchors.open();
  ::unsetenv("TMPDIR");
  if (kept) ::setenv("TMPDIR", kept->c_str(), 1);
  EXPECT_EQ(status.code(), StatusCode::kIo);
  EXPECT_NE(std::string(status.message()).find("cannot be kept in"), std::string::npos) << status.message();
}

}  // namespace
}  // namespace plvo::cli
