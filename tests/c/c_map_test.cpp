// SPDX-License-Identifier: Apache-2.0
// The map for C: the bits of C++, saved and loaded through the caller's functions, without memory of its own;
// nonsense is answered with words.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "allocation_guard.hpp"
#include "c_support.hpp"
#include "page_functions.h"
#include "plvo/c/map.h"
#include "plvo/map/map.hpp"
#include "procedural_sequence.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

constexpr int kMapWidth = 160, kMapHeight = 120;
constexpr int kMapViews = 100;
const Limits kMapTrackLimits{kMapWidth, kMapHeight, 250, 64, 2, 1, 0};

// Bytes of a saved map, which are written and read in pieces.
struct MapTape {
  std::vector<unsigned char> bytes;
  std::size_t at = 0;
};
std::int32_t write_tape(void* context, const void* bytes, std::size_t count) {
  auto& tape = *static_cast<MapTape*>(context);
  if (tape.at + count > tape.bytes.size()) return 1;
  std::memcpy(tape.bytes.data() + tape.at, bytes, count);
  tape.at += count;
  return 0;
}
std::int32_t read_tape(void* context, void* bytes, std::size_t count) {
  auto& tape = *static_cast<MapTape*>(context);
  if (tape.at + count > tape.bytes.size()) return 1;
  std::memcpy(bytes, tape.bytes.data() + tape.at, count);
  tape.at += count;
  return 0;
}

class CMap : public testing::Test {
 protected:
  CMap() : camera_(c_camera(sequence_.camera())) {
    plvo_map_limits_init(&map_limits_, sizeof map_limits_);
    map_limits_.keyframes = 64;
    const plvo_limits limits = c_limits(kMapTrackLimits);
    block_.resize(plvo_required_bytes(&limits));
    EXPECT_EQ(plvo_init(block_.data(), block_.size(), &camera_, nullptr, &limits, &odometry_).code, PLVO_OK);
    map_block_.resize(plvo_map_required_bytes(&camera_, &map_limits_));
    const plvo_status status =
        plvo_map_init(map_block_.data(), map_block_.size(), &camera_, nullptr, &map_limits_, &map_);
    EXPECT_EQ(status.code, PLVO_OK) << status.message;
    in_map_.struct_size = sizeof in_map_;
  }
  RgbdFrame frame(int view) {
    RgbdFrame frame = sequence_.render(view);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(taken_++);
    return frame;
  }
  void see(const RgbdFrame& frame) {
    const plvo_frame c = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    AllocationGuard guard;
    (void)plvo_track(odometry_, &c, &result);
    EXPECT_EQ(plvo_map_update(map_, odometry_, &result, &in_map_).code, PLVO_OK);
    EXPECT_EQ(guard.calls(), 0);
    guard.disarm();
  }
  void move(int from, int to) {
    for (int view = from; view != to; view += from < to ? 1 : -1) see(frame(view));
  }

  ProceduralSequence sequence_{kMapWidth, kMapHeight};
  plvo_camera camera_;
  plvo_map_limits map_limits_ = {};
  std::vector<std::byte> block_, map_block_;
  plvo_odometry* odometry_ = nullptr;
  plvo_map* map_ = nullptr;
  plvo_map_result in_map_ = {};
  int taken_ = 0;
};

void expect_says(const plvo_status& status, std::int32_t code, const char* words) {
  EXPECT_EQ(status.code, code);
  EXPECT_NE(std::strstr(status.message, words), nullptr) << status.message;
}

TEST_F(CMap, GivesTheMapOfCpp) {
  std::vector<std::byte> block(required_bytes(kMapTrackLimits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(block, sequence_.camera(), Config(), kMapTrackLimits).ok());
  const MapLimits limits{64, 200, 64};
  std::vector<std::byte> map_block(Map::required_bytes(limits, kMapWidth, kMapHeight));
  Map map;
  ASSERT_TRUE(map.init(map_block, sequence_.camera(), Config(), limits).ok());
  for (int i = 0; i < 4 * kMapViews && !HasFailure(); ++i) {
    const int step = i % (2 * kMapViews);
    const RgbdFrame seen = frame(step < kMapViews ? step : 2 * kMapViews - step);
    see(seen);
    const MapResult result = map.update(odometry, odometry.track(seen));
    EXPECT_EQ(result.located ? 1 : 0, in_map_.located);
    EXPECT_EQ(result.recognised ? 1 : 0, in_map_.recognised);
    EXPECT_EQ(result.keyframe, in_map_.keyframe);
    expect_same(result.T_map_world, in_map_.T_map_world);
    expect_same(result.pose_covariance, in_map_.pose_covariance);
    expect_same(result.T_keyframe_camera, in_map_.T_keyframe_camera);
    EXPECT_EQ(result.removed, in_map_.removed);
  }
  EXPECT_GT(plvo_map_loops(map_), 0U);
  EXPECT_EQ(plvo_map_keyframes(map_), map.graph().size());
  double T[12];
  ASSERT_EQ(plvo_map_keyframe_pose(map_, 2, T), 1);
  expect_same(*map.keyframe_pose(2), T);
  EXPECT_EQ(plvo_map_keyframe_pose(map_, 100000, T), 0);
  EXPECT_EQ(plvo_map_settle(map_).code, PLVO_OK);
}

// The camera's pose in the map is not known then, however sure the caller is of the pose in the new world.
TEST_F(CMap, IsNotLocatedInAnotherWorld) {
  move(0, 40);
  EXPECT_EQ(in_map_.located, 1);
  plvo_reset(odometry_);
  const double T[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  double covariance[36] = {};
  for (int i = 0; i < 6; ++i) covariance[7 * i] = 1;
  ASSERT_EQ(plvo_set_pose(odometry_, T, covariance).code, PLVO_OK);
  see(frame(20));
  EXPECT_EQ(in_map_.located, 0);
}

TEST_F(CMap, IsSavedAndLoadedThroughTheCallersFunctions) {
  for (int round = 0; round < 2; ++round) {
    move(0, kMapViews);
    move(kMapViews, 0);
  }
  MapTape tape;
  tape.bytes.resize(plvo_map_saved_bytes(map_));
  ASSERT_EQ(plvo_map_save(map_, write_tape, &tape).code, PLVO_OK);
  tape.bytes.resize(tape.at);
  EXPECT_EQ(tape.at, plvo_map_saved_bytes(map_));
  const std::size_t keyframes = plvo_map_keyframes(map_);

  tape.at = 0;
  plvo_reset(odometry_);
  const plvo_status loaded = plvo_map_load(map_, read_tape, &tape);
  ASSERT_EQ(loaded.code, PLVO_OK) << loaded.message;
  EXPECT_EQ(plvo_map_keyframes(map_), keyframes);
  see(frame(20));
  EXPECT_EQ(in_map_.located, 0);
  move(21, 50);
  EXPECT_EQ(in_map_.located, 1);

  tape.bytes.resize(tape.bytes.size() - 1);
  tape.at = 0;
  expect_says(plvo_map_load(map_, read_tape, &tape), PLVO_IO, "function to read the map failed");
  EXPECT_EQ(plvo_map_keyframes(map_), 0U);
  tape.bytes.assign(100, 'x');
  tape.at = 0;
  expect_says(plvo_map_load(map_, read_tape, &tape), PLVO_DAMAGED, "this is not a map");
}

TEST_F(CMap, TheFunctionsOfThePageSaveAndLoadAFile) {
  move(0, 10);
  const test::TemporaryFolder folder;
  const std::string path = (folder / "room.map").string();
  ASSERT_EQ(save_map(map_, path.c_str(), (path + ".part").c_str()).code, PLVO_OK);
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
  EXPECT_EQ(std::filesystem::file_size(path), plvo_map_saved_bytes(map_));
  ASSERT_EQ(load_map(map_, path.c_str()).code, PLVO_OK);
  EXPECT_EQ(plvo_map_saved_bytes(map_), std::filesystem::file_size(path));
  expect_says(load_map(map_, (path + ".part").c_str()), PLVO_IO, "cannot open the file");
  expect_says(save_map(map_, folder.path().c_str(), (path + ".part").c_str()), PLVO_IO,
              "cannot write the file");
}

TEST_F(CMap, InvalidArgumentsAreRefusedWithAMessage) {
  MapTape tape;
  plvo_result result = {};
  result.struct_size = sizeof result;
  expect_says(plvo_map_save(map_, write_tape, &tape), PLVO_NOT_FOUND, "no keyframe yet");
  move(0, 2);
  expect_says(plvo_map_save(map_, write_tape, &tape), PLVO_IO, "function to write the map failed");
  expect_says(plvo_map_save(map_, nullptr, &tape), PLVO_INVALID_ARGUMENT, "write is NULL");
  expect_says(plvo_map_load(map_, nullptr, &tape), PLVO_INVALID_ARGUMENT, "read is NULL");
  for (const plvo_status& status :
       {plvo_map_save(nullptr, write_tape, &tape), plvo_map_load(nullptr, read_tape, &tape),
        plvo_map_settle(nullptr), plvo_map_update(nullptr, odometry_, &result, &in_map_)})
    expect_says(status, PLVO_INVALID_ARGUMENT, "map is NULL");
  expect_says(plvo_map_update(map_, nullptr, &result, &in_map_), PLVO_INVALID_ARGUMENT, "odometry is NULL");
  expect_says(plvo_map_update(map_, odometry_, nullptr, &in_map_), PLVO_INVALID_ARGUMENT, "result is NULL");
  expect_says(plvo_map_update(map_, odometry_, &result, nullptr), PLVO_INVALID_ARGUMENT,
              "map_result is NULL");
  expect_says(plvo_map_update(map_, odometry_, &result, &in_map_), PLVO_INVALID_ARGUMENT, "not a rotation");
  EXPECT_EQ(plvo_map_keyframes(nullptr) + plvo_map_loops(nullptr) + plvo_map_saved_bytes(nullptr), 0U);
  double T[12];
  EXPECT_EQ(plvo_map_keyframe_pose(nullptr, 1, T) + plvo_map_keyframe_pose(map_, 1, nullptr), 0);

  plvo_map* map = nullptr;
  std::vector<std::byte> small(100);
  expect_says(plvo_map_init(small.data(), small.size(), &camera_, nullptr, &map_limits_, &map),
              PLVO_OUT_OF_MEMORY, "for these map limits");
  expect_says(plvo_map_init(nullptr, 0, &camera_, nullptr, &map_limits_, &map), PLVO_INVALID_ARGUMENT,
              "memory is NULL");
  expect_says(plvo_map_init(small.data(), small.size(), nullptr, nullptr, &map_limits_, &map),
              PLVO_INVALID_ARGUMENT, "camera is NULL");
  expect_says(plvo_map_init(small.data(), small.size(), &camera_, nullptr, &map_limits_, nullptr),
              PLVO_INVALID_ARGUMENT, "map is NULL: nowhere");
  map_limits_.keyframes = 7;
  EXPECT_EQ(plvo_map_required_bytes(&camera_, &map_limits_), 0U);
  expect_says(plvo_map_init(small.data(), small.size(), &camera_, nullptr, &map_limits_, &map),
              PLVO_INVALID_ARGUMENT, "MapLimits::keyframes");
  EXPECT_EQ(map, nullptr);
}

}  // namespace
}  // namespace plvo
