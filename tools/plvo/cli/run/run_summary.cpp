// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plvo/eval/statistics.hpp"

namespace plvo::cli {
namespace {

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
  if (!record.has_pose()) {
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

std::vector<std::pair<std::string, std::string>> RunSummary::rows() const {
  std::vector<std::pair<std::string, std::string>> rows;
  rows.emplace_back("frames", fmt::format("{}{}", frames_, interrupted ? " (interrupted)" : ""));
  rows.emplace_back("tracked", fmt::format("{}", tracked_ + initialised_));
  rows.emplace_back("lost", fmt::format("{}", lost_));
  for (const auto& [reason, count] : reasons_) rows.emplace_back(fmt::format("  {} times", count), reason);
  rows.emplace_back("damaged", fmt::format("{}", damaged_));
  if (unpaired_images > 0) rows.emplace_back("colour without depth", fmt::format("{}", unpaired_images));
  rows.emplace_back("path", fmt::format("{:.3f} m", path_m_));
  rows.emplace_back("inliers, median",
                    fmt::format("{:.0f} points, {:.0f} lines", eval::statistics(point_inliers_).median,
                                eval::statistics(line_inliers_).median));
  const eval::Statistics total = eval::statistics(stage_ms_[kStageCount]);
  rows.emplace_back("CPU per frame", fmt::format("{:.2f} ms median, {:.2f} p95, {:.2f} max", total.median,
                                                 total.p95, total.max));
  rows.emplace_back(
      "arena", fmt::format("{:.2f} MiB, with scratch {:.2f}", mebibytes(arena_bytes), mebibytes(arena_peak)));
  rows.emplace_back("resident memory",
                    fmt::format("{:.2f} MiB after init, {:.2f} at the end", mebibytes(resident_start.total),
                                mebibytes(resident_end.total)));
  return rows;
}

std::string RunSummary::to_text() const {
  std::string text = camera_name + '\n';
  for (const auto& [name, value] : rows()) text += fmt::format("{:<22} {}\n", name, value);
  text += fmt::format("\n{:<10} {:>8} {:>8} {:>8}   CPU ms per frame, one thread, decoding excluded\n",
                      "stage", "median", "p95", "max");
  for (std::size_t i = 0; i <= kStageCount; ++i) {
    const eval::Statistics s = eval::statistics(stage_ms_[i]);
    text += fmt::format("{:<10} {:8.2f} {:8.2f} {:8.2f}\n", stage_name(i), s.median, s.p95, s.max);
  }
  if (!evaluation) return text;
  text += "\nagainst the ground truth (plvo eval says more)\n";
  for (const eval::RpeResult& r : evaluation->rpe) {
    const auto& [delta, estimate, still] = r;
    if (estimate.translation_m.count == 0) continue;
    text += fmt::format(
        "RPE over {:<13} {:.1f} mm, {:.3f} deg (a camera that never moves: {:.1f} mm, {:.3f} deg)\n",
        delta.text, 1e3 * estimate.translation_m.rmse, estimate.rotation_deg.rmse,
        1e3 * still.translation_m.rmse, still.rotation_deg.rmse);
  }
  text += fmt::format("ATE                    {:.1f} mm\n", 1e3 * evaluation->ate.position_m.rmse);
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
  if (evaluation) json["evaluation"] = eval::to_json(*evaluation);
  json["memory_bytes"] = {{"arena", arena_bytes},
                          {"arena_peak", arena_peak},
                          {"resident_after_init", resident_start.total},
                          {"resident_at_end", resident_end.total},
                          {"anonymous_after_init", resident_start.anonymous},
                          {"anonymous_at_end", resident_end.anonymous}};
  return json;
}

}  // namespace plvo::cli
