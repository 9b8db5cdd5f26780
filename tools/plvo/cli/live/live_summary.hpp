// SPDX-License-Identifier: Apache-2.0
// What a live session has to say at its end, for people and as JSON.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "plvo/cli/common/track_summary.hpp"
#include "plvo/cli/live/live_accelerometer.hpp"
#include "plvo/cli/live/live_capture.hpp"
#include "plvo/cli/live/live_wheels.hpp"
#include "plvo/cli/map/map_summary.hpp"

namespace plvo::cli {

class LiveSummary : public TrackSummary {
 public:
  // latency_ms: from the frame's arrival to its pose.
  void add(const FrameRecord& record, double latency_ms);

  std::string to_text() const;
  nlohmann::ordered_json to_json() const;

  // Set by the session.
  double seconds = 0;
  LiveCapture::State capture;
  std::uint64_t dropped = 0;  // by the ring: the odometry had no time for them
  std::string recording;      // path, empty: none
  std::uint64_t recorded = 0, not_recorded = 0;
  std::uint64_t dropped_lines = 0;
  AccelerometerSummary accelerometer;
  WheelSummary wheels;
  std::optional<MapSummary> map;

 private:
  DurationHistogram latency_;
};

}  // namespace plvo::cli
