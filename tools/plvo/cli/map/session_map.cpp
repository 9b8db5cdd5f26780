// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/map/session_map.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

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
              "Keep a map of at most N keyframes, which corrects the drift where a place is seen again "
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
                   "is for a map: add --map N, or leave it out");
}

// A map may take the place of the one that was read: it was read whole, and the new one comes whole.
void add_map_files(const MapOptions& options, FileRoles& files) {
  files.writes("--map-out", options.out);
  files.writes("--map-trajectory", options.trajectory);
  files.writes("--ply", options.ply);
  if (options.in != options.out) files.reads(options.in);
}

Status SessionMap::check_outputs(const MapOptions& options) {
  for (const std::string& file : {options.trajectory, options.ply})
    if (!file.empty())
      if (Status status = LineFile::check(file); !status.ok()) return status;
  return options.out.empty() ? Status() : check_map_output(options.out);
}

Status SessionMap::init(const MapOptions& options, const CameraModel& camera, const Config& config,
                        bool keep_poses) {
  options_ = options;
  if (options.keyframes == 0) return {};
  camera_ = camera;
  MapLimits limits;
  limits.keyframes = options.keyframes;
  memory_.assign(Map::required_bytes(limits, camera.width, camera.height), std::byte{0});
  if (Status status = map_.init(memory_, camera, config, limits); !status.ok()) return status;
  latest_.emplace();
  if (keep_poses || !options.trajectory.empty() || !options.ply.empty())
    if (Status status = anchors_.open(); !status.ok()) return status;
  if (options.in.empty()) return {};
  const Status status = load_map(options.in, map_);
  loaded_ = map_.graph().size();
  return status;
}

bool SessionMap::writes() const {
  return !options_.out.empty() || !options_.trajectory.empty() || !options_.ply.empty();
}

void SessionMap::add(const Odometry& odometry, const FrameRecord& record) {
  if (!latest_) return;
  const std::int64_t start_ns = posix_thread_cpu_ns();
  const MapResult& result = latest_.emplace(map_.update(odometry, record.result));
  cpu_.add(static_cast<double>(posix_thread_cpu_ns() - start_ns) * 1e-6);
  const std::int64_t stamp_ns = record.result.stamp_ns;
  recognised_ += result.recognised ? 1 : 0;
  if (result.located && !located_stamp_ns_) located_stamp_ns_ = stamp_ns;
  if (result.removed != 0) anchors_.add_removed(result.removed, result.removed_into, result.T_into_removed);
  if (!record.has_pose()) return;
  last_stamp_ns_ = stamp_ns;
  if (!first_stamp_ns_) first_stamp_ns_ = stamp_ns;
  if (result.keyframe != 0) anchors_.add_frame(stamp_ns, result.keyframe, result.T_keyframe_camera);
}

void SessionMap::way_in_world(std::vector<Vector3>& positions) const {
  positions.clear();
  if (!latest_ || !latest_->located) return;
  const Se3 T_world_map = latest_->T_map_world.inverse();
  for (std::size_t k = 0; k < map_.graph().size(); ++k)
    if (const std::uint16_t slot = map_.graph().slot_at(k); map_.graph().is_placed(slot))
      positions.push_back(T_world_map * map_.graph().node(slot).T_map_keyframe.t);
}

void SessionMap::finish() {
  if (!latest_ || map_.graph().size() == 0) return;
  if (map_.settle()) ++recognised_;
  if (map_.located() && !located_stamp_ns_ && first_stamp_ns_) located_stamp_ns_ = last_stamp_ns_;
}

std::optional<MapSummary> SessionMap::summary() const {
  if (!latest_) return std::nullopt;
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
  return summary;
}

// One that fails does not take the others with it; the first failure is told.
Status SessionMap::write() {
  if (!latest_) return {};
  const Status saved = options_.out.empty() ? Status() : save_map(options_.out, map_);
  const Status trajectory = options_.trajectory.empty() ? Status() : write_trajectory();
  const Status ply = options_.ply.empty() ? Status() : write_ply();
  return !saved.ok() ? saved : !trajectory.ok() ? trajectory : ply;
}

Status SessionMap::write_trajectory() {
  LineFile file;
  if (Status status = file.open(options_.trajectory, kTrajectoryHeader); !status.ok()) return status;
  return poses([&file](std::int64_t stamp_ns, const Se3& T_map_camera) {
    return file.write(trajectory_line(stamp_ns, T_map_camera));
  });
}

Status SessionMap::write_ply() {
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
  const Status placed = poses([&](std::int64_t, const Se3& T_map_camera) {
    const std::size_t at = scene.add(T_map_camera.t, 0, 90, 255);
    if (last) scene.join(*last, at);
    last = at;
    return Status();
  });
  if (!placed.ok()) return placed;
  LineFile file;
  if (Status status = file.open(options_.ply); !status.ok()) return status;
  return file.write(scene.text());
}

}  // namespace plvo::cli
