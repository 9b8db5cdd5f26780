// SPDX-License-Identifier: Apache-2.0
// What was tracked and what it took, for people and as JSON: the part of a summary that `plvo run` and `plvo
// live` share. Its memory is fixed: a session may last for weeks.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "plvo/cli/common/count_histogram.hpp"
#include "plvo/cli/common/duration_histogram.hpp"
#include "plvo/cli/common/frame_record.hpp"
#include "plvo/host/resident_memory.hpp"

namespace plvo::cli {

using SummaryRows = std::vector<std::pair<std::string, std::string>>;  // name, value

class TrackSummary {
 public:
  void add(const FrameRecord& record);

  std::uint64_t frames() const { return frames_; }
  std::uint64_t tracked() const { return tracked_; }  // got a motion
  std::uint64_t lost() const { return lost_; }
  std::uint64_t damaged() const { return damaged_; }
  // A sequence of a single frame has no motion to find and cannot fail.
  bool failed() const { return tracked_ == 0 && (lost_ > 0 || started_ == 0); }
  // "no frame could be tracked", and the words of the last loss of the most frequent kind.
  std::string why_failed() const;

  // Set by the command.
  std::string camera_name;
  bool interrupted = false;
  std::vector<std::string> warnings;  // what was said on standard error
  std::size_t arena_bytes = 0, arena_peak = 0;
  ResidentMemory resident_start, resident_end;

 protected:
  SummaryRows frame_rows() const;  // tracked, lost and why
  SummaryRows cost_rows() const;   // path, processor time, memory
  std::string stage_table() const;
  nlohmann::ordered_json to_json() const;

 private:
  static constexpr std::size_t kKinds = static_cast<std::size_t>(StatusCode::kNotConverged) + 1;

  std::uint64_t frames_ = 0, started_ = 0, tracked_ = 0, predicted_ = 0, repeated_ = 0, relocalised_ = 0,
                restarted_ = 0, worlds_ = 0, lost_ = 0, damaged_ = 0;
  std::uint64_t frames_with_fewer_features_ = 0;  // for the budget's sake
  int lowest_step_ = 0;
  double path_m_ = 0;
  Se3 last_pose_;
  std::uint32_t world_ = 0;                     // of the last pose
  std::array<std::uint64_t, kKinds> losses_{};  // by kind: the words of one kind differ from frame to frame
  std::array<Status, kKinds> last_loss_;
  std::array<DurationHistogram, kStageCount + 1> stages_;  // the last one: the whole of track()
  DurationHistogram elapsed_;
  CountHistogram point_inliers_, line_inliers_;
};

// One row a line, in two columns.
std::string to_text(const SummaryRows& rows);
nlohmann::ordered_json to_json(const DurationHistogram& durations);

}  // namespace plvo::cli
