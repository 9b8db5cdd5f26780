// SPDX-License-Identifier: Apache-2.0
// A map that is saved and loaded: the same bytes, the same behaviour, a camera that finds its place in it,
// and every way in which a file can be wrong.
#include "plvo/map/map_file.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "fingerprint.hpp"
#include "mapped_camera.hpp"

namespace plvo {
namespace {

using test::kFar;
using test::kHeight;
using test::kMirror;
using test::kTurn;
using test::kWidth;
using test::MappedCamera;

using Bytes = std::vector<std::byte>;

Bytes save(Map& map) {
  Bytes bytes(map.saved_bytes());
  SpanSink sink(bytes);
  AllocationGuard guard;
  const Status status = map.save(sink);
  EXPECT_EQ(guard.calls(), 0);
  guard.disarm();
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(sink.size(), map.saved_bytes());
  EXPECT_LE(sink.size(), bytes.size());
  bytes.resize(sink.size());
  return bytes;
}

Status load(const Bytes& bytes, Map& map) {
  SpanSource source(bytes);
  AllocationGuard guard;
  const Status status = map.load(source);
  EXPECT_EQ(guard.calls(), 0);
  guard.disarm();
  EXPECT_TRUE(!status.ok() || source.left() == 0);
  return status;
}

void expect_same(const MappedCamera& a, const MappedCamera& b) {
  EXPECT_EQ(a.in_map.T_map_world.R, b.in_map.T_map_world.R);
  EXPECT_EQ(a.in_map.T_map_world.t, b.in_map.T_map_world.t);
  EXPECT_EQ(a.in_map.pose_covariance, b.in_map.pose_covariance);
  EXPECT_EQ(a.in_map.T_keyframe_camera.t, b.in_map.T_keyframe_camera.t);
  EXPECT_EQ(a.in_map.located, b.in_map.located);
  EXPECT_EQ(a.in_map.recognised, b.in_map.recognised);
  EXPECT_EQ(a.in_map.keyframe, b.in_map.keyframe);
  EXPECT_EQ(a.in_map.removed, b.in_map.removed);
}

// A map with loops, of which keyframes were removed if it is small.
class MapFile : public testing::TestWithParam<int> {};

TEST_P(MapFile, BehavesAsTheMapThatWasSaved) {
  MappedCamera saved(GetParam()), loaded(GetParam());
  for (int round = 0; round < 2; ++round) {
    saved.move(0, kFar);
    saved.move(kFar, 0);
  }
  const Bytes bytes = save(saved.map);
  EXPECT_FALSE(saved.map.graph().loops().empty());
  EXPECT_EQ(saved.map.counts().removed > 0, GetParam() == 12);
  const Status status = load(bytes, loaded.map);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(save(loaded.map), bytes);
  saved.odometry.reset();
  for (int view = 20; view < kTurn && !HasFailure(); ++view) {
    saved.see(view);
    loaded.see(view);
    expect_same(saved, loaded);
  }
  EXPECT_TRUE(loaded.in_map.located);
  EXPECT_EQ(save(saved.map), save(loaded.map));
}

INSTANTIATE_TEST_SUITE_P(LargeAndFull, MapFile, testing::Values(64, 12));

TEST(MapFile, ACameraThatIsSwitchedOnFindsItsPlace) {
  MappedCamera first(64);
  for (int round = 0; round < 2; ++round) {
    first.move(0, kFar);
    first.move(kFar, 0);
  }
  const Bytes bytes = save(first.map);
  for (const int start : {10, 30, 50}) {
    MappedCamera second(64);
    ASSERT_TRUE(load(bytes, second.map).ok());
    EXPECT_FALSE(second.map.located()) << "no frame was seen";
    int frames = 0;
    for (int view = start; view < start + 30 && !second.in_map.located; ++view, ++frames) second.see(view);
    ASSERT_TRUE(second.in_map.located) << start;
    std::printf("from view %d on: found after %d frames, %.1f mm from the truth\n", start, frames,
                1e3 * second.error_m(start + frames - 1));
    EXPECT_LT(second.error_m(start + frames - 1), 0.1);
    EXPECT_LT(std::sqrt(second.in_map.pose_covariance(0, 0)), 0.1);
    EXPECT_TRUE(second.map.located());
    second.settle(start + frames);
    EXPECT_LT(second.error_m(start + frames), 0.1);
    EXPECT_EQ(second.wrong_loops(), 0);
    EXPECT_TRUE(second.map.keyframe_pose(1)) << "the map of the first session is a part of it";
  }
}

TEST(MapFile, ACameraInAnotherRoomDoesNotKnowWhereItIs) {
  MappedCamera first(64), second(64);
  for (int round = 0; round < 2; ++round) {
    first.move(0, kFar);
    first.move(kFar, 0);
  }
  const Bytes bytes = save(first.map);
  ASSERT_TRUE(load(bytes, second.map).ok());
  for (int view = kMirror; view < kMirror + kFar; ++view) {
    second.see(view);
    EXPECT_FALSE(second.in_map.located);
    EXPECT_GT(second.in_map.pose_covariance(0, 0), 1e3);
  }
  EXPECT_GT(second.map.counts().keyframes, 5);
  EXPECT_EQ(second.map.counts().loops, 0);
  // Both rooms are in the map, and the first is found again.
  const Bytes both = save(second.map);
  MappedCamera third(64);
  ASSERT_TRUE(load(both, third.map).ok());
  third.move(20, 50);
  EXPECT_TRUE(third.in_map.located);
  EXPECT_LT(third.error_m(49), 0.1);
}

// Every compiler, optimisation level and processor must give these bytes. If a change of the odometry, of the
// map or of the format alters them on purpose, the new number stands in the message.
TEST(MapFile, GivesTheSameBytesEverywhere) {
  constexpr std::uint64_t kGolden = 7180908676832356532U;
  MappedCamera camera(12);
  camera.move(0, kFar);
  camera.move(kFar, 0);
  Fingerprint bits;
  for (const std::byte byte : save(camera.map)) bits.add_byte(static_cast<std::uint8_t>(byte));
  EXPECT_EQ(bits.value(), kGolden);
}

TEST(MapFile, NumbersAreLittleEndianAndTheChecksumIsThatOfGzip) {
  Crc32 crc;
  crc.add(std::as_bytes(std::span("123456789", 9)));
  EXPECT_EQ(crc.value(), 0xcbf43926U);
  Bytes bytes(13);
  SpanSink sink(bytes);
  MapWriter writer(sink);
  writer.whole(0x04030201, 4);
  writer.number(-2.0);
  writer.whole(7, 1);
  ASSERT_TRUE(writer.finish().ok());
  const std::uint8_t expected[] = {1, 2, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0xc0, 7};
  EXPECT_EQ(std::memcmp(bytes.data(), expected, sizeof expected), 0);
}

// Files that are wrong in one place each.
class WrongMapFile : public testing::Test {
 protected:
  static constexpr std::size_t kHeader = 80;  // bytes

  WrongMapFile() : bytes_(small_map()) {}

  static Bytes small_map() {
    static const Bytes bytes = [] {
      MappedCamera camera(12);
      for (int round = 0; round < 2; ++round) {
        camera.move(0, kFar);
        camera.move(kFar, 0);
      }
      return save(camera.map);
    }();
    return bytes;
  }
  template <typename Number>
  void put(std::size_t at, Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      bytes_[at + i] = reinterpret_cast<const std::byte*>(&value)[i];  // tests run on little-endian machines
  }
  template <typename Number>
  Number get(std::size_t at) const {
    Number value;
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }
  // Sets the checksums right, so that only the content is wrong.
  void seal() {
    Crc32 header, body;
    const std::span<const std::byte> all(bytes_);
    header.add(all.first(kHeader - 4));
    put(kHeader - 4, header.value());
    body.add(all.subspan(kHeader, all.size() - kHeader - 4));
    put(all.size() - 4, body.value());
  }
  void expect_refused(StatusCode code, const std::string& words, MapLimits limits = {12, 200, 64},
                      CameraModel camera = ProceduralSequence(kWidth, kHeight).camera()) {
    std::vector<std::byte> memory(Map::required_bytes(limits, camera.width, camera.height));
    Map map;
    EXPECT_TRUE(map.init(memory, camera, Config(), limits).ok());
    const Status status = load(bytes_, map);
    EXPECT_EQ(status.code(), code) << status.message();
    EXPECT_NE(std::string(status.message()).find(words), std::string::npos) << status.message();
    EXPECT_EQ(map.graph().size(), 0U);
    EXPECT_TRUE(code != StatusCode::kDamaged || load(small_map(), map).ok());
  }
  Bytes bytes_;
};

TEST_F(WrongMapFile, BytesThatAreNoMap) {
  bytes_[0] = std::byte{'q'};
  expect_refused(StatusCode::kDamaged, "this is not a map");
  bytes_.clear();
  expect_refused(StatusCode::kDamaged, "this is not a map");
}

TEST_F(WrongMapFile, IsRefusedWhenOfAnotherVersion) {
  put(8, std::uint32_t{2});
  expect_refused(StatusCode::kUnsupported, "the map has format 2, and this plvo reads format 1");
}

TEST_F(WrongMapFile, IsRefusedWhenCutOffAnywhere) {
  const Bytes whole = bytes_;
  for (std::size_t size = 8; size < whole.size(); size += 1 + size / 20) {
    bytes_.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    expect_refused(StatusCode::kDamaged, "the map is cut off");
  }
}

TEST_F(WrongMapFile, IsRefusedWhenABitFlipped) {
  for (std::size_t at = 12; at < bytes_.size(); at += 1 + at / 20) {
    bytes_[at] ^= std::byte{16};
    expect_refused(StatusCode::kDamaged, "the map is");
    bytes_[at] ^= std::byte{16};
  }
}

TEST_F(WrongMapFile, IsRefusedWhenOfAnotherCamera) {
  CameraModel camera = ProceduralSequence(kWidth, kHeight).camera();
  camera.pinhole.fx += 1;
  expect_refused(StatusCode::kInvalidArgument, "made with another camera", {12, 200, 64}, camera);
}

TEST_F(WrongMapFile, IsRefusedWhenTheMapHasNoRoomForIt) {
  expect_refused(StatusCode::kOutOfMemory, "the map needs room for 12 keyframes", {11, 200, 64});
  expect_refused(StatusCode::kOutOfMemory, "the map needs room", {12, 50, 64});
  expect_refused(StatusCode::kOutOfMemory, "the map needs room", {12, 200, 1});
}

TEST_F(WrongMapFile, NumbersThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const float nan32 = std::numeric_limits<float>::quiet_NaN();
  // Offsets: of the header, of the first keyframe, and of its first point and line.
  constexpr std::size_t kPoses = kHeader + 14, kCovariances = kPoses + 2 * 96;
  constexpr std::size_t kPoint = kCovariances + 2 * 288;
  const std::size_t line = kPoint + 48 * get<std::uint16_t>(kHeader + 10);
  const std::size_t loop = bytes_.size() - 4 - (4 + 96 + 288);
  ASSERT_GT(get<std::uint16_t>(kHeader + 12), 0) << "lines of the first keyframe";
  const std::vector<std::pair<const char*, std::function<void()>>> faults = {
      {"its header", [&] { put(16, 0x10000000U); }},       // height
      {"its header", [&] { put(20, nan); }},               // fx
      {"its header", [&] { put(52, std::uint32_t{0}); }},  // keyframes
      {"its header", [&] { put(52, std::uint32_t{513}); }},
      {"its header", [&] { put(56, std::uint32_t{513}); }},          // loops
      {"its header", [&] { put(68, std::uint32_t{401}); }},          // most points
      {"its header", [&] { put(60, std::uint32_t{4000000000U}); }},  // points
      {"its number", [&] { put(60, get<std::uint32_t>(60) - 1); }},
      {"a keyframe", [&] { put(kHeader, std::uint32_t{0}); }},  // id
      {"a keyframe", [&] { put(kHeader, 0xffffffffU); }},
      {"a keyframe", [&] { put(kHeader + 4, std::uint32_t{2}); }},     // part
      {"a keyframe", [&] { put(kHeader + 8, std::uint16_t{12}); }},    // slot
      {"a keyframe", [&] { put(kHeader + 8, std::uint16_t{1}); }},     // of another one
      {"a keyframe", [&] { put(kHeader + 10, std::uint16_t{201}); }},  // points
      {"a keyframe", [&] { put(kHeader + 12, std::uint16_t{65}); }},   // lines
      {"a keyframe", [&] { put(kPoses, 1.1); }},                       // no rotation
      {"a keyframe", [&] { put(kPoses + 72, 1e9); }},                  // far away
      {"a keyframe", [&] { put(kPoses + 96 + 80, nan); }},
      {"a keyframe", [&] { put(kCovariances, -1.0); }},
      {"a keyframe", [&] { put(kCovariances + 288, nan); }},
      {"a keyframe", [&] { put(kPoint + 32, nan32); }},             // u
      {"a keyframe", [&] { put(kPoint + 36, 121.0F); }},            // v
      {"a keyframe", [&] { put(kPoint + 40, 0.0F); }},              // depth
      {"a keyframe", [&] { put(kPoint + 44, std::uint16_t{0}); }},  // its standard deviation
      {"a keyframe", [&] { put(kPoint + 46, std::uint8_t{4}); }},   // level
      {"a keyframe", [&] { put(kPoint + 47, std::uint8_t{8}); }},   // tables
      {"a keyframe", [&] { put(line + 72, nan32); }},
      {"a keyframe",
       [&] {  // a line without length
         for (std::size_t i = 0; i < 12; ++i) bytes_[line + 84 + i] = bytes_[line + 72 + i];
       }},
      {"a keyframe", [&] { put(line + 96, -1.0F); }},  // a variance
      {"a loop", [&] { put(loop, std::uint16_t{12}); }},
      {"a loop", [&] { put(loop, get<std::uint16_t>(loop + 2)); }},
      {"a loop", [&] { put(loop + 4, 2.0); }},
      {"a loop", [&] { put(loop + 100, nan); }},
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    SCOPED_TRACE(i);
    bytes_ = small_map();
    faults[i].second();
    seal();
    expect_refused(StatusCode::kDamaged, faults[i].first);
  }
}

TEST(MapFile, RefusesToSaveAnEmptyMapOrIntoTooFewBytes) {
  Map map;
  Bytes bytes(100);
  SpanSink sink(bytes);
  SpanSource source(bytes);
  EXPECT_EQ(map.save(sink).code(), StatusCode::kNotFound);
  EXPECT_EQ(map.load(source).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(map.saved_bytes(), 0U);
  MappedCamera camera(12);
  EXPECT_EQ(camera.map.save(sink).code(), StatusCode::kNotFound);
  camera.move(0, 3);
  const Status status = camera.map.save(sink);
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  EXPECT_NE(std::string(status.message()).find("Map::saved_bytes()"), std::string::npos);
}

TEST(MapFile, TheHeaderSaysWhatIsNeeded) {
  MappedCamera camera(12);
  camera.move(0, kTurn);
  const Bytes bytes = save(camera.map);
  SpanSource source(bytes);
  MapFileInfo info;
  ASSERT_TRUE(read_map_info(source, info).ok());
  EXPECT_EQ(info.keyframes, camera.map.graph().size());
  EXPECT_EQ(info.bytes(), bytes.size());
  EXPECT_LE(info.bytes(), most_map_file_bytes());
  std::vector<std::byte> memory(Map::required_bytes(info.limits(), info.width, info.height));
  Map map;
  ASSERT_TRUE(map.init(memory, info.camera(), Config(), info.limits()).ok());
  EXPECT_TRUE(load(bytes, map).ok());
}

}  // namespace
}  // namespace plvo
