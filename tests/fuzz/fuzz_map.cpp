// SPDX-License-Identifier: Apache-2.0
// Any bytes as a saved map. What is accepted can be saved and loaded again with the same bytes, and gives no
// number that is not finite: not when its keyframes are compared, not when its graph is solved, and not when
// a camera goes on in it. Most inputs get checksums that are right, or nothing but them would be tested.
#include <algorithm>
#include <vector>

#include "plvo/map/map.hpp"
#include "procedural_sequence.hpp"
#include "scratch_file.hpp"

namespace {

using namespace plvo;

constexpr MapLimits kFuzzedMap{8, 50, 16};
constexpr int kSide = 64;
constexpr std::size_t kHeader = 80, kChecksum = 4;

std::span<const std::byte> all_but_the_end(std::span<const std::byte> bytes) {
  return bytes.first(bytes.size() - kChecksum);
}

void seal(std::span<std::byte> part) {
  Crc32 crc;
  crc.add(all_but_the_end(part));
  for (std::size_t i = 0; i < kChecksum; ++i)
    part[part.size() - kChecksum + i] = static_cast<std::byte>(crc.value() >> (8 * i));
}

std::vector<std::byte> save(Map& map) {
  std::vector<std::byte> bytes(map.saved_bytes());
  SpanSink sink(bytes);
  fuzz::require(map.save(sink).ok() && sink.size() == bytes.size());
  return bytes;
}

void compare_and_solve(const Map& map, const CameraModel& camera, std::span<std::byte> memory) {
  const LoopCheck check(camera, Config());
  Arena arena(memory);
  // A copy that works on the same nodes.
  PoseGraph graph = map.graph();
  for (std::size_t k = 1; k < graph.size(); ++k) {
    const std::uint16_t a = graph.slot_at(k - 1), b = graph.slot_at(k);
    const LoopMeasurement loop = check(map.features(a), map.features(b), arena);
    fuzz::require(loop.T_old_new.is_finite() && loop.covariance.allFinite());
    graph.join_parts(a, b, loop.T_old_new, loop.covariance);
    graph.add_loop(a, b, loop.T_old_new, loop.covariance);
  }
  for (int i = 0; i < 1000 && !graph.idle(); ++i) graph.step();
  fuzz::require(graph.idle());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  std::transform(data, data + size, bytes.begin(), [](std::uint8_t byte) { return std::byte{byte}; });
  if (size > kHeader + kChecksum && data[size - 1] != 0) {
    seal(std::span(bytes).first(kHeader));
    seal(std::span(bytes).subspan(kHeader));
  }
  static ProceduralSequence sequence(kSide, kSide);
  const CameraModel& camera = sequence.camera();
  static std::vector<std::byte> memory(Map::required_bytes(kFuzzedMap, kSide, kSide)), other(memory.size());
  Map map, again;
  fuzz::require(map.init(memory, camera, Config(), kFuzzedMap).ok());
  fuzz::require(again.init(other, camera, Config(), kFuzzedMap).ok());
  SpanSource source(bytes);
  if (const Status status = map.load(source); !status.ok()) {
    fuzz::require(!std::string_view(status.message()).empty() && map.graph().size() == 0);
    return 0;
  }
  const std::vector<std::byte> saved = save(map);
  SpanSource saved_source(saved);
  fuzz::require(again.load(saved_source).ok() && save(again) == saved);

  constexpr Limits kLimits{.width = kSide,
                           .height = kSide,
                           .keypoints = 50,
                           .segments = 16,
                           .references = 2,
                           .kept_keyframes = 0,
                           .surfaces = 0};
  static std::vector<std::byte> block(required_bytes(kLimits));
  Odometry odometry;
  fuzz::require(odometry.init(block, camera, Config(), kLimits).ok());
  for (int i = 0; i < 3; ++i) {
    RgbdFrame frame = sequence.render(10 * i);
    frame.stamp_ns = frame.depth_stamp_ns = ProceduralSequence::stamp_ns(i);
    const TrackResult result = odometry.track(frame);
    const MapResult in_map = map.update(odometry, result);
    fuzz::require(in_map.T_map_world.is_finite() && in_map.pose_covariance.allFinite());
  }
  (void)map.settle();
  compare_and_solve(again, camera, memory);
  return 0;
}
