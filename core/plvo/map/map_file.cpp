// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/map_file.hpp"

#include <algorithm>

#include "plvo/image/pyramid.hpp"
#include "plvo/map/map.hpp"
#include "plvo/math/covariance.hpp"

namespace plvo {
namespace {

constexpr std::array<char, 8> kMapMagic = {'p', 'l', 'v', 'o', ' ', 'm', 'a', 'p'};
constexpr std::size_t kPoseBytes = 12 * 8, kMatrixBytes = 36 * 8;
constexpr std::size_t kHeaderBytes = 8 + 4 + 2 * 4 + 4 * 8 + 6 * 4 + 4;
constexpr std::size_t kKeyframeFileBytes = 2 * 4 + 3 * 2 + 2 * kPoseBytes + 2 * kMatrixBytes;
constexpr std::size_t kPointBytes = 4 * 8 + 3 * 4 + 2 + 2;
constexpr std::size_t kLineBytes = kMsldLength + 16 * 4;
constexpr std::size_t kLoopBytes = 2 * 2 + kPoseBytes + kMatrixBytes;
constexpr std::size_t kEndBytes = 4;
// Ids below this leave room for more keyframes than a camera makes in years.
constexpr std::uint32_t kMostId = 1U << 30;
// Bounds on the numbers of a file. They are far beyond those of a map, and their squares are finite.
constexpr double kMostCoordinate_m = 1e8, kMostStoredVariance = 1e20;
constexpr float kMostReach_m = 1e5F, kMostLineVariance_m2 = 1e6F;

// The largest limits.
constexpr MapLimits kMostMap{MapLimits::kMostKeyframes, MapLimits::kMostKeypoints, MapLimits::kMostSegments};

Status damaged(const char* what) {
  return Status(StatusCode::kDamaged, "the map is damaged: ")
      .append(what)
      .append(" is impossible; make the map again, or use a copy");
}

bool lies_between(float value, float least, float most) { return value >= least && value <= most; }

bool is_pose(const Se3& T) {
  return T.is_finite() && is_rotation(T.R) && T.t.cwiseAbs().maxCoeff() <= kMostCoordinate_m;
}

bool is_plausible(const Matrix6& covariance) {
  return is_covariance(covariance) && covariance.diagonal().maxCoeff() <= kMostStoredVariance;
}

void write_info(const MapFileInfo& info, MapWriter& writer) {
  for (const char c : kMapMagic) writer.whole(static_cast<std::uint8_t>(c), 1);
  writer.whole(MapFileInfo::kVersion, 4);
  writer.whole(static_cast<std::uint32_t>(info.width), 4);
  writer.whole(static_cast<std::uint32_t>(info.height), 4);
  for (const double value : {info.pinhole.fx, info.pinhole.fy, info.pinhole.cx, info.pinhole.cy})
    writer.number(value);
  for (const std::uint32_t value :
       {info.keyframes, info.loops, info.points, info.lines, info.most_points, info.most_lines})
    writer.whole(value, 4);
  writer.checksum();
}

Status read_info(MapReader& reader, MapFileInfo& info) {
  bool is_map = true;
  for (const char c : kMapMagic) is_map = reader.whole(1) == static_cast<std::uint8_t>(c) && is_map;
  if (!is_map)
    return {StatusCode::kDamaged, "this is not a map that plvo saved: its first bytes are not \"plvo map\""};
  if (const std::uint32_t version = reader.whole32();
      version != MapFileInfo::kVersion && reader.status().ok())
    return Status(StatusCode::kUnsupported, "the map has format ")
        .append(version)
        .append(", and this plvo reads format ")
        .append(MapFileInfo::kVersion)
        .append(": take the plvo that made it, or make the map again");
  const std::uint32_t width = reader.whole32(), height = reader.whole32();
  for (double* value : {&info.pinhole.fx, &info.pinhole.fy, &info.pinhole.cx, &info.pinhole.cy})
    *value = reader.number();
  for (std::uint32_t* value :
       {&info.keyframes, &info.loops, &info.points, &info.lines, &info.most_points, &info.most_lines})
    *value = reader.whole32();
  const bool whole = reader.checksum();
  if (!reader.status().ok()) return reader.status();
  constexpr std::uint32_t kMostSide = 1U << 16;
  if (!whole || width > kMostSide || height > kMostSide) return damaged("its header");
  info.width = static_cast<int>(width);
  info.height = static_cast<int>(height);
  const auto most = [](int limit) { return static_cast<std::uint32_t>(limit); };
  if (!info.camera().validate().ok() || info.keyframes == 0 || info.keyframes > most(kMostMap.keyframes) ||
      info.loops > most(kMostMap.keyframes) || info.most_points > most(kMostMap.keypoints) ||
      info.most_lines > most(kMostMap.segments) || info.points > info.keyframes * info.most_points ||
      info.lines > info.keyframes * info.most_lines)
    return damaged("its header");
  return {};
}

void write_point(const Descriptor& descriptor, const MapPoint& point, std::uint8_t tables,
                 MapWriter& writer) {
  for (const std::uint64_t word : descriptor) writer.whole(word, 8);
  for (const float value : {point.u, point.v, point.depth_m}) writer.number(value);
  writer.whole(point.sigma_100um, 2);
  writer.whole(point.level, 1);
  writer.whole(tables, 1);
}

bool read_point(const MapFileInfo& info, MapReader& reader, Descriptor& descriptor, MapPoint& point,
                std::uint8_t& tables) {
  for (std::uint64_t& word : descriptor) word = reader.whole(8);
  for (float* value : {&point.u, &point.v, &point.depth_m}) *value = reader.number_of_32_bits();
  point.sigma_100um = reader.whole16();
  point.level = static_cast<std::uint8_t>(reader.whole(1));
  tables = static_cast<std::uint8_t>(reader.whole(1));
  return lies_between(point.u, 0, static_cast<float>(info.width)) &&
         lies_between(point.v, 0, static_cast<float>(info.height)) &&
         lies_between(point.depth_m, static_cast<float>(kNearestSeen_m), kMostReach_m) &&
         point.sigma_100um > 0 && point.level < Pyramid::kMaxLevels && tables < 1U << PlaceIndex::kTables;
}

void write_line(const LineDescriptor& descriptor, const MapLine& line, MapWriter& writer) {
  writer.bytes(std::as_bytes(std::span(descriptor.value)));
  for (const float value : line.a) writer.number(value);
  for (const float value : line.b) writer.number(value);
  for (const float value : line.across) writer.number(value);
}

bool read_line(MapReader& reader, LineDescriptor& descriptor, MapLine& line) {
  reader.bytes(std::as_writable_bytes(std::span(descriptor.value)));
  bool possible = true;
  const auto read = [&](auto& values, float most) {
    for (float& value : values) {
      value = reader.number_of_32_bits();
      possible = possible && lies_between(value, -most, most);
    }
  };
  read(line.a, kMostReach_m);
  read(line.b, kMostReach_m);
  read(line.across, kMostLineVariance_m2);
  for (const unsigned variance : {0U, 2U, 5U, 9U}) possible = possible && line.across[variance] >= 0;
  return possible && line.a != line.b;
}

}  // namespace

std::size_t MapFileInfo::bytes() const {
  return kHeaderBytes + keyframes * kKeyframeFileBytes + points * kPointBytes + lines * kLineBytes +
         loops * kLoopBytes + kEndBytes;
}

MapLimits MapFileInfo::limits() const {
  const auto at_least = [](std::uint32_t held, int least) { return std::max(static_cast<int>(held), least); };
  return {at_least(std::max(keyframes, loops), MapLimits::kLeastKeyframes),
          at_least(most_points, MapLimits::kLeastKeypoints), at_least(most_lines, MapLimits::kLeastSegments)};
}

CameraModel MapFileInfo::camera() const {
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.pinhole = pinhole;
  return camera;
}

Status read_map_info(ByteSource& source, MapFileInfo& info) {
  MapReader reader(source);
  return read_info(reader, info);
}

std::size_t most_map_file_bytes() {
  MapFileInfo most;
  most.keyframes = most.loops = static_cast<std::uint32_t>(kMostMap.keyframes);
  most.points = most.keyframes * static_cast<std::uint32_t>(kMostMap.keypoints);
  most.lines = most.keyframes * static_cast<std::uint32_t>(kMostMap.segments);
  return most.bytes();
}

MapFileInfo Map::file_info() const {
  MapFileInfo info;
  info.width = check_.camera.width;
  info.height = check_.camera.height;
  info.pinhole = check_.camera.pinhole;
  info.keyframes = static_cast<std::uint32_t>(memory_.graph.size());
  info.loops = static_cast<std::uint32_t>(memory_.graph.loops().size());
  for (std::size_t k = 0; k < memory_.graph.size(); ++k) {
    const MapFeatures features = memory_.features.at(memory_.graph.slot_at(k));
    const auto points = static_cast<std::uint32_t>(features.points.size());
    const auto lines = static_cast<std::uint32_t>(features.lines.size());
    info.points += points;
    info.lines += lines;
    info.most_points = std::max(info.most_points, points);
    info.most_lines = std::max(info.most_lines, lines);
  }
  return info;
}

std::size_t Map::saved_bytes() const { return ready_ ? file_info().bytes() : 0; }

// Finds the neighbours of all nodes, so that the saved map and the loaded one have the same.
void Map::find_all_neighbours() {
  std::fill(memory_.neighbours.begin(), memory_.neighbours.end(), MapMemory::Neighbour());
  for (std::size_t k = 0; k < memory_.graph.size(); ++k) find_neighbour(memory_.graph.slot_at(k));
  refreshed_ = 0;
}

Status Map::save(ByteSink& sink) {
  if (!ready_ || memory_.graph.size() == 0)
    return {StatusCode::kNotFound, "the map holds no keyframe yet, so nothing was saved"};
  (void)settle();
  find_all_neighbours();
  MapWriter writer(sink);
  write_info(file_info(), writer);
  for (std::size_t k = 0; k < memory_.graph.size(); ++k) write_keyframe(memory_.graph.slot_at(k), writer);
  for (const PoseGraph::Loop& loop : memory_.graph.loops()) {
    writer.whole(loop.older, 2);
    writer.whole(loop.newer, 2);
    writer.pose(loop.T_older_newer);
    writer.matrix(loop.covariance);
  }
  writer.checksum();
  return writer.finish();
}

void Map::write_keyframe(std::uint16_t slot, MapWriter& writer) {
  const PoseGraph::Node& node = memory_.graph.node(slot);
  const MapFeatures features = memory_.features.at(slot);
  writer.whole(node.id, 4);
  writer.whole(node.part, 4);
  writer.whole(slot, 2);
  writer.whole(features.points.size(), 2);
  writer.whole(features.lines.size(), 2);
  writer.pose(node.T_map_keyframe);
  writer.pose(node.T_previous_keyframe);
  writer.matrix(node.motion_covariance);
  writer.matrix(node.covariance);
  for (std::size_t i = 0; i < features.points.size(); ++i)
    write_point(features.descriptors[i], features.points[i],
                memory_.index.tables_of(all_descriptors(), slot * memory_.features.keypoints() + i), writer);
  for (std::size_t i = 0; i < features.lines.size(); ++i)
    write_line(features.line_descriptors[i], features.lines[i], writer);
}

// Whether the map is of this camera and has room for it.
Status Map::fits(const MapFileInfo& info) const {
  const CameraModel& camera = check_.camera;
  const Pinhole& is = camera.pinhole;
  const Pinhole& was = info.pinhole;
  if (info.width != camera.width || info.height != camera.height || is.fx != was.fx || is.fy != was.fy ||
      is.cx != was.cx || is.cy != was.cy)
    return {
        StatusCode::kInvalidArgument,
        "the map was made with another camera: its image size and its fx, fy, cx and cy must be the same; "
        "give that calibration, or make the map again"};
  const MapLimits needed = info.limits();
  if (static_cast<std::size_t>(needed.keyframes) > memory_.graph.capacity() ||
      info.most_points > memory_.features.keypoints() || info.most_lines > memory_.features.segments())
    return Status(StatusCode::kOutOfMemory, "the map needs room for ")
        .append(needed.keyframes)
        .append(" keyframes of ")
        .append(static_cast<std::ptrdiff_t>(info.most_points))
        .append(" points and ")
        .append(static_cast<std::ptrdiff_t>(info.most_lines))
        .append(" lines, more than these MapLimits have (--map, MapLimits::keyframes)");
  return {};
}

Status Map::load(ByteSource& source) {
  if (!ready_) return {StatusCode::kInvalidArgument, "Map::init must be called before a map is loaded"};
  clear();
  MapReader reader(source);
  MapFileInfo info;
  if (Status status = read_info(reader, info); !status.ok()) return status;
  if (Status status = fits(info); !status.ok()) return status;
  const char* wrong = nullptr;
  for (std::uint32_t k = 0; k < info.keyframes && wrong == nullptr; ++k)
    if (!read_keyframe(info, reader)) wrong = "a keyframe";
  for (std::uint32_t i = 0; i < info.loops && wrong == nullptr; ++i)
    if (!read_loop(info, reader)) wrong = "a loop";
  if (wrong == nullptr && !reader.checksum()) wrong = "its checksum";
  if (wrong == nullptr) {
    const MapFileInfo read = file_info();
    if (read.points != info.points || read.lines != info.lines) wrong = "its number of points or lines";
  }
  if (wrong != nullptr) {
    clear();
    return reader.status().ok() ? damaged(wrong) : reader.status();
  }
  find_all_neighbours();
  return {};
}

bool Map::read_keyframe(const MapFileInfo& info, MapReader& reader) {
  PoseGraph::Node node;
  node.id = reader.whole32();
  node.part = reader.whole32();
  const std::uint16_t slot = reader.whole16(), points = reader.whole16(), lines = reader.whole16();
  node.T_map_keyframe = reader.pose();
  node.T_previous_keyframe = reader.pose();
  node.motion_covariance = reader.matrix();
  node.covariance = reader.matrix();
  const PoseGraph& graph = memory_.graph;
  if (node.id < graph.next_id() || node.id > kMostId || node.part == 0 || node.part > node.id ||
      slot >= info.keyframes || graph.node(slot).id != 0 || points > info.most_points ||
      lines > info.most_lines || !is_pose(node.T_map_keyframe) || !is_pose(node.T_previous_keyframe) ||
      !is_plausible(node.motion_covariance) || !is_plausible(node.covariance))
    return false;
  const MapFeatures features = memory_.features.make_room(slot, points, lines);
  for (std::size_t i = 0; i < points; ++i) {
    std::uint8_t tables = 0;
    if (!read_point(info, reader, features.descriptors[i], features.points[i], tables)) return false;
    memory_.index.add_to_tables(all_descriptors(), slot * memory_.features.keypoints() + i, tables);
  }
  for (std::size_t i = 0; i < lines; ++i)
    if (!read_line(reader, features.line_descriptors[i], features.lines[i])) return false;
  memory_.graph.restore(slot, node);
  measure_depth(slot);
  return true;
}

bool Map::read_loop(const MapFileInfo& info, MapReader& reader) {
  PoseGraph::Loop loop;
  loop.older = reader.whole16();
  loop.newer = reader.whole16();
  loop.T_older_newer = reader.pose();
  loop.covariance = reader.matrix();
  const PoseGraph& graph = memory_.graph;
  if (loop.older >= info.keyframes || loop.newer >= info.keyframes ||
      graph.node(loop.older).position >= graph.node(loop.newer).position || !is_pose(loop.T_older_newer) ||
      !is_plausible(loop.covariance))
    return false;
  memory_.graph.restore(loop);
  return true;
}

}  // namespace plvo
