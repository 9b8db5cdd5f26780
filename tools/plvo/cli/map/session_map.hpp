// SPDX-License-Identifier: Apache-2.0
// `--map` of `plvo run` and `plvo live`: a map beside the odometry, and the files that are written of it at
// the end. The memory stays, however long the session lasts.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/map/frame_anchors.hpp"
#include "plvo/cli/map/map_summary.hpp"
#include "plvo/cli/options/arguments.hpp"
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

class SessionMap {
 public:
  // Whether the files that are written at the end can be.
  static Status check_outputs(const MapOptions& options);
  // Does nothing, as all that follows, where no map was asked for. keep_poses: for poses(), where no file
  // that was asked for needs them.
  Status init(const MapOptions& options, const CameraModel& camera, const Config& config, bool keep_poses);
  // Called for each tracked frame, right after track(). Allocates nothing.
  void add(const Odometry& odometry, const FrameRecord& record);
  // Whether files will be written at the end.
  bool writes() const;
  // The result of the latest frame; empty without a map.
  const std::optional<MapResult>& latest() const { return latest_; }
  const Map& map() const { return map_; }
  // Positions of the keyframes as the map corrects them, in the world of the odometry, where the camera has
  // its pose; none while the camera is not located.
  void way_in_world(std::vector<Vector3>& positions) const;

  // After the last frame.
  void finish();
  // Then, nothing without a map; without ate_m.
  std::optional<MapSummary> summary() const;
  // The poses of all frames of which the map knows them, with all corrections.
  Status poses(const FrameAnchors::Use& use) { return anchors_.for_each(map_, use); }
  // Writes the files that were asked for.
  Status write();

 private:
  Status write_trajectory();
  Status write_ply();

  MapOptions options_;
  std::vector<std::byte> memory_;
  CameraModel camera_;
  Map map_;
  std::optional<MapResult> latest_;
  FrameAnchors anchors_;
  std::size_t loaded_ = 0;  // keyframes
  std::optional<std::int64_t> first_stamp_ns_, located_stamp_ns_;
  std::int64_t last_stamp_ns_ = 0;  // of a frame that had a pose
  int recognised_ = 0;
  DurationHistogram cpu_;
};

}  // namespace plvo::cli
