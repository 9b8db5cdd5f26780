// SPDX-License-Identifier: Apache-2.0
// `--map`: a map beside the odometry, and the files that are written of it at the end of a run.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/duration_histogram.hpp"
#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/map/map.hpp"

namespace plvo::cli {

struct MapOptions {
  int keyframes = 0;  // 0: no map
  std::string trajectory, ply;
  std::string in, out;  // saved maps
};
void add_map_options(CLI::App& command, MapOptions& options);
void check_map_options(const CLI::App& command, const MapOptions& options);
void add_map_files(const MapOptions& options, FileRoles& files);

struct MapSummary {
  std::size_t loaded = 0;  // keyframes of --map-in
  bool located = false;    // at the end
  // From the first frame that had a pose to that which was located first.
  std::optional<double> located_after_s;
  std::size_t keyframes = 0, capacity = 0, bytes = 0;
  int removed = 0, compared = 0, accepted = 0, recognised = 0, loops = 0;
  DurationHistogram cpu;        // of Map::update()
  std::optional<double> ate_m;  // where there is ground truth
};

class RunMap {
 public:
  // Does nothing, as all that follows, where no map was asked for. expected_frames: room made at once.
  Status init(const MapOptions& options, const CameraModel& camera, const Config& config,
              std::size_t expected_frames);
  // Whether the files that are written at the end can be.
  Status check_outputs() const;
  // Called for each tracked frame, right after track().
  void add(const Odometry& odometry, const FrameRecord& record);

  // After the last frame.
  void finish();
  // Nothing without a map.
  std::optional<MapSummary> summary(const OpenedCamera& camera) const;
  // Writes the files that were asked for.
  Status write();

 private:
  // A frame and its pose relative to the keyframe that was the latest then.
  struct Anchored {
    std::int64_t stamp_ns = 0;
    std::uint32_t keyframe = 0;
    Se3 T_keyframe_camera;
  };
  struct Removed {
    std::uint32_t into = 0;
    Se3 T_into_removed;
  };
  // The poses of all frames of which the map knows them, with all corrections.
  eval::Trajectory trajectory() const;
  Status write_ply() const;

  MapOptions options_;
  std::vector<std::byte> memory_;
  CameraModel camera_;
  Map map_;
  std::vector<Anchored> frames_;
  std::map<std::uint32_t, Removed> removed_;
  std::size_t loaded_ = 0;
  std::optional<std::int64_t> first_stamp_ns_, located_stamp_ns_;
  int recognised_ = 0;
  DurationHistogram cpu_;
};

}  // namespace plvo::cli
