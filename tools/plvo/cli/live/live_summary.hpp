// SPDX-License-Identifier: Apache-2.0
// What a live session has to say at its end, for people and as JSON. Its memory is fixed: a session may last
// for weeks.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "plvo/cli/common/duration_histogram.hpp"
#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/common/resident_memory.hpp"
#include "plvo/cli/live/live_capture.hpp"

namespace plvo::cli {

class LiveSummary {
 public:
  void add(const FrameRecord& record, double latency_ms);

  std::uint64_t frames() const { return frames_; }
  std::uint64_t tracked() const { return tracked_; }  // got a motion
  std::uint64_t lost() const { return lost_; }
  std::string main_reason() const;  // the words of the last loss of the most frequent kind

  std::string to_text() const;
  nlohmann::ordered_json to_json() const;

  // Set by the session.
  std::string camera_name;
  double seconds = 0;
  bool interrupted = false;
  LiveCapture::State capture;
  std::uint64_t dropped = 0;  // by the ring: the odometry had no time for them
  std::string recording;      // path, empty: none
  std::uint64_t recorded = 0, not_recorded = 0;
  std::uint64_t dropped_lines = 0;
  std::size_t arena_bytes = 0, arena_peak = 0;
  ResidentMemory resident_start, resident_end;

 private:
  static constexpr std::size_t kCodes = 16;
  std::uint64_t frames_ = 0, initialised_ = 0, tracked_ = 0, lost_ = 0;
  double path_m_ = 0;
  Se3 last_pose_;
  bool has_pose_ = false;
  std::array<std::uint64_t, kCodes> reasons_{};
  std::array<Status, kCodes> last_reason_;
  DurationHistogram latency_, cpu_;
};

}  // namespace plvo::cli
