// SPDX-License-Identifier: Apache-2.0
// What a run has to say at its end, for people and as JSON.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/common/resident_memory.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::cli {

class RunSummary {
 public:
  // expected_frames: room that is made (and touched) at once, so that the summary itself does not grow during
  // the run.
  explicit RunSummary(std::size_t expected_frames);

  void add(const FrameRecord& record);

  std::size_t frames() const { return frames_; }
  std::size_t tracked() const { return tracked_; }  // frames that got a motion
  std::size_t lost() const { return lost_; }
  std::size_t damaged() const { return damaged_; }
  // Why most of the lost frames were lost; empty when none was.
  std::string main_reason() const;

  // The figures as rows of two columns.
  std::vector<std::pair<std::string, std::string>> rows() const;
  std::string to_text() const;
  nlohmann::ordered_json to_json() const;

  // Set by the run.
  std::string camera_name;
  std::size_t unpaired_images = 0;
  std::size_t arena_bytes = 0, arena_peak = 0;
  ResidentMemory resident_start, resident_end;
  bool interrupted = false;
  std::optional<eval::Evaluation> evaluation;  // where there is ground truth

 private:
  std::size_t frames_ = 0, initialised_ = 0, tracked_ = 0, lost_ = 0, damaged_ = 0;
  double path_m_ = 0;
  Se3 last_pose_;
  bool has_pose_ = false;
  std::map<std::string, std::size_t> reasons_;
  std::array<std::vector<double>, kStageCount + 1> stage_ms_;  // the last one: the whole of track()
  std::vector<double> point_inliers_, line_inliers_;
};

}  // namespace plvo::cli
