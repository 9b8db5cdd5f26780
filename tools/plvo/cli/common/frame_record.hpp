// SPDX-License-Identifier: Apache-2.0
// What became of one frame: what every output of a run is made from.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::cli {

struct FrameRecord {
  std::size_t number = 0;  // from 0, counting damaged frames too
  // Not ok: the camera could not give this frame out, and of what follows only the stamp holds.
  Status camera_status;
  TrackResult result;
  std::int64_t cpu_ns = 0;      // of track() alone, on all its cores
  std::int64_t elapsed_ns = 0;  // from its call to its result

  bool damaged() const { return !camera_status.ok(); }
  bool has_pose() const { return !damaged() && plvo::has_pose(result); }
};

}  // namespace plvo::cli
