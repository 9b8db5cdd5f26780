// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/map/evaluation.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "plvo/bench/sequences/scaled_camera.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/posix_clock.hpp"

namespace plvo::bench {
namespace {

class FileSink final : public ByteSink {
 public:
  explicit FileSink(std::vector<std::byte>& file) : file_(file) {}
  Status write(std::span<const std::byte> bytes) override {
    file_.insert(file_.end(), bytes.begin(), bytes.end());
    return {};
  }

 private:
  std::vector<std::byte>& file_;
};

}  // namespace

void need(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "map_study: %s\n", status.message());
  std::exit(1);
}

SimulatorOptions simulated(SceneName scene, LightName light, std::uint64_t seed, int width, int frames) {
  SimulatorOptions options;
  options.scene = scene;
  options.light = light;
  options.seed = seed;
  options.frames = frames;
  options.threads = 1;
  options.camera = scaled(options.camera, static_cast<double>(width) / options.camera.width);
  return options;
}

PoseError pose_error(const Se3& estimate, const Se3& truth) {
  const Vector6 error = boxminus(estimate, truth);
  return {error.head<3>().norm(), error.tail<3>().norm()};
}

MappedOdometry::MappedOdometry(const CameraModel& camera, int keyframes) {
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  memory_.resize(required_bytes(limits));
  need(odometry.init(memory_, camera, Config(), limits));
  MapLimits map_limits;
  map_limits.keyframes = keyframes;
  map_memory_.resize(Map::required_bytes(map_limits, camera.width, camera.height));
  need(map.init(map_memory_, camera, Config(), map_limits));
}

MapEvaluation::MapEvaluation(const CameraModel& camera, int keyframes)
    : MappedOdometry(camera, keyframes), camera_(camera) {
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  black_.resize(3 * pixels);
  no_depth_.resize(pixels);
}

void MapEvaluation::see(const RgbdFrame& frame, const Se3& T_world_camera) {
  truth_[frame.stamp_ns] = T_world_camera;
  const std::int64_t start_ns = posix_thread_cpu_ns();
  result = odometry.track(frame);
  track_ms_.push_back(1e-6 * static_cast<double>(posix_thread_cpu_ns() - start_ns));
  lost_ += result.state == TrackState::kLost ? 1 : 0;
  update();
  if (has_pose(result) && in_map.keyframe != 0)
    frames_.push_back({in_map.keyframe, in_map.T_keyframe_camera, result.T_world_camera, T_world_camera});
}

void MapEvaluation::see_nothing(std::int64_t stamp_ns) {
  RgbdFrame frame;
  frame.stamp_ns = frame.depth_stamp_ns = stamp_ns;
  frame.colour = {black_.data(), camera_.width, camera_.height, std::ptrdiff_t{3} * camera_.width,
                  PixelFormat::kRgb8};
  frame.depth = {no_depth_.data(), camera_.width, camera_.height, camera_.width, 0.001};
  result = odometry.track(frame);
  update();
}

void MapEvaluation::update() {
  const Map::Counts before = map.counts();
  const std::int64_t start_ns = posix_thread_cpu_ns();
  in_map = map.update(odometry, result);
  map_ms_.push_back(1e-6 * static_cast<double>(posix_thread_cpu_ns() - start_ns));
  if (map.counts().keyframes > before.keyframes)
    keyframes_[in_map.keyframe] = truth_.at(odometry.keyframe().features->stamp_ns);
  if (map.counts().loops > before.loops) judge_loops();
  if (in_map.removed != 0) {
    removed_[in_map.removed] = {in_map.removed_into, in_map.T_into_removed};
    note_loops();
  }
}

void MapEvaluation::settle() {
  map.settle();
  judge_loops();
}

// A loop that went to a neighbour of a removed keyframe was judged before.
void MapEvaluation::note_loops() {
  for (const PoseGraph::Loop& loop : map.graph().loops())
    known_loops_.insert({map.graph().node(loop.older).id, map.graph().node(loop.newer).id});
}

void MapEvaluation::judge_loops() {
  for (const PoseGraph::Loop& loop : map.graph().loops()) {
    const std::uint32_t older = map.graph().node(loop.older).id, newer = map.graph().node(loop.newer).id;
    if (!known_loops_.insert({older, newer}).second) continue;
    loops_.push_back(pose_error(loop.T_older_newer, keyframes_.at(older).inverse() * keyframes_.at(newer)));
  }
}

int MapEvaluation::wrong_loops() const {
  return static_cast<int>(
      std::count_if(loops_.begin(), loops_.end(), [](const PoseError& error) { return error.wrong(); }));
}

std::vector<std::byte> MapEvaluation::save() {
  std::vector<std::byte> file;
  FileSink sink(file);
  need(map.save(sink));
  judge_loops();
  return file;
}

// The keyframes that joined since the map was saved are gone, and their ids come again.
void MapEvaluation::load(const std::vector<std::byte>& file) {
  SpanSource source(file);
  need(map.load(source));
  odometry.reset();
  frames_.clear();
  known_loops_.clear();
  note_loops();
}

MapEvaluation::Poses MapEvaluation::poses() const {
  Poses all;
  for (const Frame& frame : frames_) {
    ++all.frames;
    Se3 T = frame.T_keyframe_camera;
    std::uint32_t id = frame.keyframe;
    for (auto gone = removed_.find(id); gone != removed_.end(); gone = removed_.find(id)) {
      T = gone->second.second * T;
      id = gone->second.first;
    }
    const std::optional<Se3> keyframe = map.keyframe_pose(id);
    if (!keyframe) continue;
    all.odometry.push_back(frame.T_world_camera);
    all.map.push_back(*keyframe * T);
    all.truth.push_back(frame.truth);
  }
  return all;
}

}  // namespace plvo::bench
