// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/run_map.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/eval/evaluation.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/map_files.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/posix_clock.hpp"

namespace plvo::cli {
namespace {

// Vertices and edges of a PLY file, as text.
class PlyScene {
 public:
  std::size_t add(const Vector3& p, int red, int green, int blue) {
    fmt::format_to(std::back_inserter(vertices_), "{:.4f} {:.4f} {:.4f} {} {} {}\n", p.x(), p.y(), p.z(), red,
                   green, blue);
    return vertex_count_++;
  }
  void join(std::size_t a, std::size_t b) {
    fmt::format_to(std::back_inserter(edges_), "{} {}\n", a, b);
    ++edge_count_;
  }
  // Without the last newline, which LineFile adds.
  std::string text() const {
    std::string all = fmt::format(
        "ply\nformat ascii 1.0\ncomment plvo: points grey, lines orange, trajectory blue; metres\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
        vertex_count_, edge_count_);
    all += vertices_ + edges_;
    all.pop_back();
    return all;
  }

 private:
  std::string vertices_, edges_;
  std::size_t vertex_count_ = 0, edge_count_ = 0;
};

}  // namespace

void add_map_options(CLI::App& command, MapOptions& options) {
  OptionGroup group(command, "Map");
  group.whole("--map", options.keyframes, MapLimits::kLeastKeyframes, MapLimits::kMostKeyframes,
              "Keep a map of up to so many keyframes, which corrects the drift where a place is seen again "
              "(24 KB each)");
  group.path("--map-in", options.in,
             "Begin with this map: the camera is found in it when it sees a place of it");
  group.path("--map-out", options.out, "Save the map at the end; may be the file of --map-in");
  group.path("--map-trajectory", options.trajectory,
             "Poses of all frames in the map, with all corrections, TUM format; written at the end");
  group.path("--ply", options.ply,
             "Points, lines and trajectory of the map, for MeshLab and CloudCompare; written at the end");
}

void check_map_options(const CLI::App& command, const MapOptions& options) {
  if (options.keyframes == 0)
    refuse_options(command, {"--map-in", "--map-out", "--map-trajectory", "--ply"},
                   "is for a map: add --map N, or leave it away");
}

// A map may take the place of the one that was read: it was read whole, and the new one comes whole.
void add_map_files(const MapOptions& options, FileRoles& files) {
  files.writes("--map-out", options.out);
  files.writes("--map-trajectory", options.trajectory);
  files.writes("--ply", options.ply);
  if (options.in != options.out) files.reads(options.in);
}

Status RunMap::init(const MapOptions& options, const CameraModel& camera, const Config& config,
                    std::size_t expected_frames) {
  options_ = options;
  if (options.keyframes == 0) return {};
  camera_ = camera;
  MapLimits limits;
  limits.keyframes = options.keyframes;
  memory_.assign(Map::required_bytes(limits, camera.width, camera.height), std::byte{0});
  frames_.resize(expected_frames);
  frames_.clear();
  if (Status status = map_.init(memory_, camera, config, limits); !status.ok() || options.in.empty())
    return status;
  const Status status = load_map(options.in, map_);
  loaded_ = map_.graph().size();
  return status;
}

Status RunMap::check_outputs() const {
  if (options_.keyframes == 0) return {};
  for (const std::string& file : {options_.trajectory, options_.ply})
    if (!file.empty())
      if (Status status = LineFile::check(file); !status.ok()) return status;
  return options_.out.empty() ? Status() : check_map_output(options_.out);
}

void RunMap::add(const Odometry& odometry, const FrameRecord& record) {
  if (options_.keyframes == 0) return;
  const std::int64_t start_ns = posix_thread_cpu_ns();
  const MapResult result = map_.update(odometry, record.result);
  cpu_.add(static_cast<double>(posix_thread_cpu_ns() - start_ns) * 1e-6);
  recognised_ += result.recognised ? 1 : 0;
  if (record.has_pose() && !first_stamp_ns_) first_stamp_ns_ = record.result.stamp_ns;
  if (result.located && !located_stamp_ns_) located_stamp_ns_ = record.result.stamp_ns;
  if (result.removed != 0) removed_[result.removed] = {result.removed_into, result.T_into_removed};
  if (record.has_pose() && result.keyframe != 0)
    frames_.push_back({record.result.stamp_ns, result.keyframe, result.T_keyframe_camera});
}

void RunMap::finish() {
  if (options_.keyframes == 0 || map_.graph().size() == 0) return;
  if (map_.settle()) ++recognised_;
  if (map_.located() && !located_stamp_ns_ && !frames_.empty()) located_stamp_ns_ = frames_.back().stamp_ns;
}

eval::Trajectory RunMap::trajectory() const {
  eval::Trajectory trajectory;
  for (const Anchored& frame : frames_) {
    Se3 T = frame.T_keyframe_camera;
    std::uint32_t id = frame.keyframe;
    for (auto at = removed_.find(id); at != removed_.end(); at = removed_.find(id)) {
      T = at->second.T_into_removed * T;
      id = at->second.into;
    }
    if (const std::optional<Se3> T_map_keyframe = map_.keyframe_pose(id))
      trajectory.poses.push_back({frame.stamp_ns, *T_map_keyframe * T});
  }
  return trajectory;
}

std::optional<MapSummary> RunMap::summary(const OpenedCamera& camera) const {
  if (options_.keyframes == 0) return std::nullopt;
  MapSummary summary;
  summary.loaded = loaded_;
  summary.located = map_.located();
  if (first_stamp_ns_ && located_stamp_ns_)
    summary.located_after_s = 1e-9 * static_cast<double>(*located_stamp_ns_ - *first_stamp_ns_);
  summary.keyframes = map_.graph().size();
  summary.capacity = static_cast<std::size_t>(options_.keyframes);
  summary.bytes = memory_.size();
  summary.removed = map_.counts().removed;
  summary.compared = map_.counts().compared;
  summary.accepted = map_.counts().accepted;
  summary.recognised = recognised_;
  summary.loops = map_.counts().loops;
  summary.cpu = cpu_;
  const eval::Trajectory poses = trajectory();
  std::vector<std::int64_t> stamps;
  for (const eval::StampedPose& pose : poses.poses) stamps.push_back(pose.stamp_ns);
  eval::Trajectory truth;
  eval::Evaluation evaluation;
  // A truth that cannot be read was reported with the odometry's own figures.
  if (camera.ground_truth && poses.poses.size() >= 2 && camera.ground_truth(stamps, truth).ok() &&
      eval::evaluate(truth, poses, {}, {}, {}, evaluation).ok())
    summary.ate_m = evaluation.ate.position_m.rmse;
  return summary;
}

Status RunMap::write() {
  if (options_.keyframes == 0) return {};
  Status saved = options_.out.empty() ? Status() : save_map(options_.out, map_);
  if (!options_.trajectory.empty()) {
    LineFile file;
    if (Status status = file.open(options_.trajectory, kTrajectoryHeader); !status.ok()) return status;
    for (const eval::StampedPose& pose : trajectory().poses)
      if (Status status = file.write(trajectory_line(pose.stamp_ns, pose.T_world_camera)); !status.ok())
        return status;
  }
  if (!options_.ply.empty())
    if (Status status = write_ply(); !status.ok()) return status;
  return saved;
}

Status RunMap::write_ply() const {
  PlyScene scene;
  for (std::size_t k = 0; k < map_.graph().size(); ++k) {
    const std::uint16_t slot = map_.graph().slot_at(k);
    if (!map_.graph().is_placed(slot)) continue;
    const Se3& T = map_.graph().node(slot).T_map_keyframe;
    const MapFeatures features = map_.features(slot);
    for (const MapPoint& point : features.points)
      scene.add(T * unpack(point, camera_.pinhole, 1).p, 160, 160, 160);
    for (const MapLine& packed : features.lines) {
      const Line3d line = unpack(packed);
      const std::size_t a = scene.add(T * line.a, 255, 140, 0);
      scene.join(a, scene.add(T * line.b, 255, 140, 0));
    }
  }
  std::optional<std::size_t> last;
  for (const eval::StampedPose& pose : trajectory().poses) {
    const std::size_t at = scene.add(pose.T_world_camera.t, 0, 90, 255);
    if (last) scene.join(*last, at);
    last = at;
  }
  LineFile file;
  if (Status status = file.open(options_.ply); !status.ok()) return status;
  return file.write(scene.text());
}

}  // namespace plvo::cli
