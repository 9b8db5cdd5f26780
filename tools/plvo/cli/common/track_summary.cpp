// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/track_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plvo/host/printable.hpp"
#include "plvo/odometry/features/feature_budget.hpp"

namespace plvo::cli {
namespace {

const char* stage_name(std::size_t index) {
  return index < kStageCount ? to_string(static_cast<Stage>(index)) : "total";
}

std::string to_text(const DurationHistogram& durations) {
  return fmt::format("{:.2f} ms median, {:.2f} p95, {:.2f} max", durations.quantile_ms(0.5),
                     durations.quantile_ms(0.95), durations.max_ms());
}

}  // namespace

void TrackSummary::add(const FrameRecord& record) {
  ++frames_;
  if (record.damaged()) {
    ++damaged_;
    return;
  }
  const TrackResult& result = record.result;
  for (std::size_t i = 0; i < kStageCount; ++i)
    stages_[i].add(static_cast<double>(result.stage_ns[i]) * 1e-6);
  stages_[kStageCount].add(static_cast<double>(record.cpu_ns) * 1e-6);
  elapsed_.add(static_cast<double>(record.elapsed_ns) * 1e-6);
  frames_with_fewer_features_ += result.feature_step > 0 ? 1 : 0;
  lowest_step_ = std::max(lowest_step_, result.feature_step);
  if (!record.has_pose()) {
    ++lost_;
    const auto kind = static_cast<std::size_t>(result.status.code());
    ++losses_[kind];
    last_loss_[kind] = result.status;
    return;
  }
  // Where a pose is put right, and where a new world starts, it jumps, and the camera does not.
  const bool new_world = worlds_ == 0 || result.world != world_;
  if (!result.relocalised && !new_world) path_m_ += (result.T_world_camera.t - last_pose_.t).norm();
  worlds_ += new_world ? 1 : 0;
  world_ = result.world;
  last_pose_ = result.T_world_camera;
  restarted_ += result.restarted ? 1 : 0;
  if (result.state == TrackState::kInitialising) {
    ++started_;
    return;
  }
  if (result.state == TrackState::kPredicted) {
    ++predicted_;
    return;
  }
  if (result.repeated) {
    ++repeated_;
    return;
  }
  ++tracked_;
  relocalised_ += result.relocalised ? 1 : 0;
  point_inliers_.add(result.points.inliers);
  line_inliers_.add(result.lines.inliers);
}

std::string TrackSummary::why_failed() const {
  const auto most = std::max_element(losses_.begin(), losses_.end());
  std::string text = "no frame could be tracked";
  if (*most > 0)
    text += fmt::format(": {}", last_loss_[static_cast<std::size_t>(most - losses_.begin())].message());
  return text;
}

SummaryRows TrackSummary::frame_rows() const {
  SummaryRows rows = {{"started", fmt::format("{} (the first frame, or after a long loss)", started_)},
                      {"tracked", fmt::format("{}", tracked_)}};
  if (predicted_ > 0)
    rows.emplace_back("predicted", fmt::format("{} (nothing seen; from gyro and accelerometer)", predicted_));
  if (repeated_ > 0)
    rows.emplace_back("repeated",
                      fmt::format("{} (the image of the frame before; pose predicted)", repeated_));
  if (relocalised_ > 0)
    rows.emplace_back("relocalised", fmt::format("{} (by a view from before a loss)", relocalised_));
  if (restarted_ > 0)
    rows.emplace_back("restarted",
                      fmt::format("{} (after a loss whose motion was not observed)", restarted_));
  if (worlds_ > 1)
    rows.emplace_back("worlds", fmt::format("{} (poses in different ones have no known relation)", worlds_));
  rows.emplace_back("lost", fmt::format("{}", lost_));
  for (std::size_t i = 0; i < kKinds; ++i)
    if (losses_[i] > 0) rows.emplace_back(fmt::format("  {} times", losses_[i]), last_loss_[i].message());
  return rows;
}

SummaryRows TrackSummary::cost_rows() const {
  SummaryRows rows = {
      {"path", fmt::format("{:.3f} m", path_m_)},
      {"inliers, median",
       fmt::format("{} points, {} lines", point_inliers_.median(), line_inliers_.median())},
      {"CPU per frame", to_text(stages_[kStageCount])},
      {"elapsed per frame", to_text(elapsed_)},
      {"arena",
       fmt::format("{:.2f} MiB, with scratch {:.2f}", mebibytes(arena_bytes), mebibytes(arena_peak))},
      {"resident memory", fmt::format("{:.2f} MiB after the start, {:.2f} at the end",
                                      mebibytes(resident_start.total), mebibytes(resident_end.total))}};
  if (lowest_step_ > 0)
    rows.emplace_back("frame budget",
                      fmt::format("{} frames with fewer features, down to step {} of {}",
                                  frames_with_fewer_features_, lowest_step_, FeatureBudget::kSteps));
  return rows;
}

std::string TrackSummary::stage_table() const {
  std::string text = fmt::format("\n{:<10} {:>8} {:>8} {:>8}   CPU ms per frame, decoding excluded\n",
                                 "stage", "median", "p95", "max");
  for (std::size_t i = 0; i <= kStageCount; ++i)
    text += fmt::format("{:<10} {:8.2f} {:8.2f} {:8.2f}\n", stage_name(i), stages_[i].quantile_ms(0.5),
                        stages_[i].quantile_ms(0.95), stages_[i].max_ms());
  return text;
}

nlohmann::ordered_json TrackSummary::to_json() const {
  nlohmann::ordered_json json = {{"camera", camera_name},   {"interrupted", interrupted},
                                 {"frames", frames_},       {"initialised", started_},
                                 {"tracked", tracked_},     {"predicted", predicted_},
                                 {"repeated", repeated_},   {"relocalised", relocalised_},
                                 {"restarted", restarted_}, {"worlds", worlds_},
                                 {"lost", lost_},           {"damaged", damaged_},
                                 {"path_m", path_m_}};
  json["lost_reasons"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kKinds; ++i)
    if (losses_[i] > 0) json["lost_reasons"][to_string(static_cast<StatusCode>(i))] = losses_[i];
  json["fewer_features"] = {{"frames", frames_with_fewer_features_}, {"lowest_step", lowest_step_}};
  json["inliers_median"] = {{"points", point_inliers_.median()}, {"lines", line_inliers_.median()}};
  for (std::size_t i = 0; i <= kStageCount; ++i) json["cpu_ms"][stage_name(i)] = cli::to_json(stages_[i]);
  json["elapsed_ms"] = cli::to_json(elapsed_);
  json["memory_bytes"] = {{"arena", arena_bytes},
                          {"arena_peak", arena_peak},
                          {"resident_after_start", resident_start.total},
                          {"resident_at_end", resident_end.total},
                          {"anonymous_after_start", resident_start.anonymous},
                          {"anonymous_at_end", resident_end.anonymous}};
  json["warnings"] = warnings;
  return json;
}

std::string to_text(const SummaryRows& rows) {
  std::string text;
  for (const auto& [name, value] : rows) text += fmt::format("{:<22} {}\n", name, printable(value));
  return text;
}

nlohmann::ordered_json to_json(const DurationHistogram& durations) {
  return {{"median", durations.quantile_ms(0.5)},
          {"mean", durations.mean_ms()},
          {"p95", durations.quantile_ms(0.95)},
          {"p99", durations.quantile_ms(0.99)},
          {"max", durations.max_ms()}};
}

}  // namespace plvo::cli
