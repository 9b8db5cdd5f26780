// SPDX-License-Identifier: Apache-2.0
#include "plvo/plvo/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "plvo/eval/statistics.hpp"

namespace plvo::cli {
namespace {

constexpr double kMebibyte = 1024.0 * 1024.0;

const char* stage_name(std::size_t index) {
  return index < kStageCount ? to_string(static_cast<Stage>(index)) : "total";
}

// reserve() alone leaves the pages untouched: they would count as growth later.
void make_room(std::vector<double>& values, std::size_t count) {
  values.assign(count, 1.0);
  values.clear();
}

}  // namespace

RunSummary::RunSummary(std::size_t expected_frames) {
  for (auto& values : stage_ms_) make_room(values, expected_frames);
  make_room(point_inliers_, expected_frames);
  make_room(line_inliers_, expected_frames);
}

void RunSummary::add(const FrameRecord& record) {
  ++frames_;
  if (record.damaged()) {
    ++damaged_;
    return;
  }
  const TrackResult& result = record.result;
  for (std::size_t i = 0; i < kStageCount; ++i)
    stage_ms_[i].push_back(static_cast<double>(result.stage_ns[i]) * 1e-6);
  stage_ms_[kStageCount].push_back(static_cast<double>(record.cpu_ns) * 1e-6);
  if (result.state == TrackState::kLost) {
    ++lost_;
    ++reasons_[result.status.message()];
    return;
  }
  if (has_pose_) path_m_ += (result.T_world_camera.t - last_pose_.t).norm();
  has_pose_ = true;
  last_pose_ = result.T_world_camera;
  if (result.state == TrackState::kInitialising) {
    ++initialised_;
    return;
  }
  ++tracked_;
  point_inliers_.push_back(result.points.inliers);
  line_inliers_.push_back(result.lines.inliers);
}

std::string RunSummary::main_reason() const {
  std::string reason;
  std::size_t most = 0;
  for (const auto& [text, count] : reasons_) {
    if (count <= most) continue;
    most = count;
    reason = text;
  }
  return reason;
}

std::string RunSummary::to_text() const {
  std::string text;
  const auto add = [&text](const std::string& line) { text += line + '\n'; };
  add(fmt::format("{}{}: {} frames, {} tracked, {} lost, {} damaged", camera_name,
                  interrupted ? " (interrupted)" : "", frames_, tracked_ + initialised_, lost_, damaged_));
  for (const auto& [reason, count] : reasons_) add(fmt::format("  lost {} times: {}", count, reason));
  if (unpaired_images > 0)
    add(fmt::format("  {} colour images have no depth image near enough", unpaired_images));
  const eval::Statistics points = eval::statistics(point_inliers_);
  const eval::Statistics lines = eval::statistics(line_inliers_);
  add(fmt::format("path {:.3f} m; inliers (median) {:.0f} points, {:.0f} lines", path_m_, points.median,
                  lines.median));
  add(fmt::format("{:<10} {:>8} {:>8} {:>8}   CPU ms per frame, one thread, decoding excluded", "stage",
                  "median", "p95", "max"));
  for (std::size_t i = 0; i <= kStageCount; ++i) {
    const eval::Statistics s = eval::statistics(stage_ms_[i]);
    add(fmt::format("{:<10} {:8.2f} {:8.2f} {:8.2f}", stage_name(i), s.median, s.p95, s.max));
  }
  add(fmt::format(
      "memory: {:.2f} MiB in the arena (peak of scratch included {:.2f}); resident {:.2f} MiB after init, "
      "{:.2f} MiB at the end, {:.2f} and {:.2f} of it the program's own",
      static_cast<double>(arena_bytes) / kMebibyte, static_cast<double>(arena_peak) / kMebibyte,
      static_cast<double>(resident_start.total) / kMebibyte,
      static_cast<double>(resident_end.total) / kMebibyte,
      static_cast<double>(resident_start.anonymous) / kMebibyte,
      static_cast<double>(resident_end.anonymous) / kMebibyte));
  return text;
}

nlohmann::ordered_json RunSummary::to_json() const {
  using Json = nlohmann::ordered_json;
  Json json = {{"camera", camera_name}, {"interrupted", interrupted},
               {"frames", frames_},     {"initialised", initialised_},
               {"tracked", tracked_},   {"lost", lost_},
               {"damaged", damaged_},   {"unpaired_images", unpaired_images},
               {"path_m", path_m_}};
  json["lost_reasons"] = Json(reasons_);
  json["inliers_median"] = {{"points", eval::statistics(point_inliers_).median},
                            {"lines", eval::statistics(line_inliers_).median}};
  for (std::size_t i = 0; i <= kStageCount; ++i) {
    const eval::Statistics s = eval::statistics(stage_ms_[i]);
    json["cpu_ms"][stage_name(i)] = {{"median", s.median}, {"mean", s.mean}, {"p95", s.p95}, {"max", s.max}};
  }
  json["memory_bytes"] = {{"arena", arena_bytes},
                          {"arena_peak", arena_peak},
                          {"resident_after_init", resident_start.total},
                          {"resident_at_end", resident_end.total},
                          {"anonymous_after_init", resident_start.anonymous},
                          {"anonymous_at_end", resident_end.anonymous}};
  return json;
}

}  // namespace plvo::cli
