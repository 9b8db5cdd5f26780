// SPDX-License-Identifier: Apache-2.0
// The map with images of real cameras. No recording here comes back to where it began, so each is cut in two:
// its even frames are seen first, then, ten seconds later, its odd ones, as if the robot had been carried
// back.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>

#include "plvo/eval/evaluation.hpp"
#include "plvo/map/map.hpp"
#include "sequences.hpp"

namespace plvo::accuracy {
namespace {

// Farther from the truth than this, a loop is wrong.
constexpr double kWrong_m = 0.15, kWrong_rad = 0.1;

class SeenTwice {
 public:
  explicit SeenTwice(const Sequence& sequence) : sequence_(sequence) {
    constexpr std::int64_t kPause_ns = 10'000'000'000;
    again_ns_ =
        sequence.frames.back().frame().stamp_ns - sequence.frames.front().frame().stamp_ns + kPause_ns;
    for (const std::int64_t later_ns : {std::int64_t{0}, again_ns_})
      for (const StampedPose& pose : sequence.truth.poses) {
        // If the truth is longer than the recording, its rest would lie in the other half.
        const bool is_of_the_frames =
            pose.stamp_ns > sequence.frames.front().frame().stamp_ns - kPause_ns / 4 &&
            pose.stamp_ns < sequence.frames.back().frame().stamp_ns + kPause_ns / 4;
        if (is_of_the_frames) truth_.poses.push_back({pose.stamp_ns + later_ns, pose.T_world_camera});
      }
  }

  // All even frames, then all odd ones.
  void track() {
    const CameraModel& camera = sequence_.camera;
    Limits limits;
    limits.width = camera.width;
    limits.height = camera.height;
    MapLimits map_limits;
    map_limits.keyframes = 256;
    memory_.resize(required_bytes(limits));
    map_memory_.resize(Map::required_bytes(map_limits, camera.width, camera.height));
    ASSERT_TRUE(odometry_.init(memory_, camera, Config(), limits).ok());
    ASSERT_TRUE(map_.init(map_memory_, camera, Config(), map_limits).ok());
    for (const std::size_t half : {0, 1})
      for (std::size_t i = half; i < sequence_.frames.size(); i += 2) {
        RgbdFrame frame = sequence_.frames[i].frame();
        frame.stamp_ns += half * again_ns_;
        frame.depth_stamp_ns += half * again_ns_;
        see(frame);
      }
    map_.settle();
  }

  std::size_t loops() const { return map_.graph().loops().size(); }
  // Loops that are wrong.
  int wrong() const {
    int wrong = 0;
    for (const PoseGraph::Loop& loop : map_.graph().loops()) {
      const std::vector<std::int64_t> stamps = {keyframes_.at(map_.graph().node(loop.older).id),
                                                keyframes_.at(map_.graph().node(loop.newer).id)};
      const eval::SampledPoses poses = eval::sample(truth_, stamps, {});
      EXPECT_TRUE(poses.valid[0] && poses.valid[1]);
      const Vector6 error = boxminus(loop.T_older_newer, poses.poses[0].inverse() * poses.poses[1]);
      if (error.head<3>().norm() > kWrong_m || error.tail<3>().norm() > kWrong_rad) ++wrong;
    }
    return wrong;
  }
  // RMSE of the positions after alignment, in metres.
  double odometry_error() const { return error_of(odometry_poses_); }
  double map_error() const {
    eval::Trajectory poses;
    for (const InMap& frame : frames_)
      poses.poses.push_back({frame.stamp_ns, *map_.keyframe_pose(frame.keyframe) * frame.T_keyframe_camera});
    return error_of(poses);
  }

 private:
  struct InMap {
    std::int64_t stamp_ns;
    std::uint32_t keyframe;
    Se3 T_keyframe_camera;
  };

  void see(const RgbdFrame& frame) {
    const TrackResult result = odometry_.track(frame);
    const MapResult in_map = map_.update(odometry_, result);
    ASSERT_EQ(in_map.removed, 0U) << "the map is large enough";
    if (in_map.keyframe == 0) return;
    keyframes_.try_emplace(in_map.keyframe, odometry_.keyframe().features->stamp_ns);
    odometry_poses_.poses.push_back({result.stamp_ns, result.T_world_camera});
    frames_.push_back({result.stamp_ns, in_map.keyframe, in_map.T_keyframe_camera});
  }

  double error_of(const eval::Trajectory& trajectory) const {
    eval::Evaluation evaluation;
    const Status status = eval::evaluate(truth_, trajectory, {}, {}, {}, evaluation);
    EXPECT_TRUE(status.ok()) << status.message();
    return evaluation.ate.position_m.rmse;
  }

  const Sequence& sequence_;
  std::int64_t again_ns_ = 0;
  eval::Trajectory truth_, odometry_poses_;
  std::vector<std::byte> memory_, map_memory_;
  Odometry odometry_;
  Map map_;
  std::map<std::uint32_t, std::int64_t> keyframes_;  // id -> stamp
  std::vector<InMap> frames_;
};

TEST(MapRecorded, RecognisesThePlacesOfRealImagesAndNoOthers) {
  const char* shared = std::getenv("PLVO_SHARED");
  const std::filesystem::path data = std::filesystem::path(shared != nullptr ? shared : "") / "data";
  if (!std::filesystem::is_directory(data))
    GTEST_SKIP() << "the recorded sequences are not here: set PLVO_SHARED to the folder that holds data/";
  for (const Recorded& recorded : recorded_sequences()) {
    Sequence sequence;
    const Status status = load(data, recorded, sequence);
    ASSERT_TRUE(status.ok()) << status.message();
    SeenTwice twice(sequence);
    twice.track();
    std::printf("%s: %zu loops, %d wrong, ATE of the odometry %.1f mm, in the map %.1f mm\n", recorded.folder,
                twice.loops(), twice.wrong(), 1e3 * twice.odometry_error(), 1e3 * twice.map_error());
    EXPECT_EQ(twice.wrong(), 0) << recorded.folder;
    // Lines alone recognise no place, and this recording has hardly any points.
    if (sequence.name != "fr3_notexture_120") {
      EXPECT_GT(twice.loops(), 0U) << recorded.folder;
    }
    EXPECT_LE(twice.map_error(), 1.02 * twice.odometry_error()) << recorded.folder;
  }
}

}  // namespace
}  // namespace plvo::accuracy
