// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

namespace plvo::cli {
namespace {

nlohmann::ordered_json to_json(const DurationHistogram& h) {
  return {{"median", h.quantile_ms(0.5)},
          {"mean", h.mean_ms()},
          {"p95", h.quantile_ms(0.95)},
          {"p99", h.quantile_ms(0.99)},
          {"max", h.max_ms()}};
}

nlohmann::ordered_json to_json(const OpenNi2Counters& c) {
  return {{"frames", c.frames},
          {"colour_images", c.colour_images},
          {"depth_images", c.depth_images},
          {"dropped_colour", c.dropped_colour},
          {"dropped_depth", c.dropped_depth},
          {"unmatched_colour", c.unmatched_colour},
          {"unmatched_depth", c.unmatched_depth},
          {"missing", c.missing},
          {"damaged", c.damaged},
          {"clock_wraps", c.clock_wraps},
          {"clock_jumps", c.clock_jumps},
          {"timeouts", c.timeouts},
          {"unplugged", c.unplugged},
          {"replugged", c.replugged}};
}

}  // namespace

void LiveSummary::add(const FrameRecord& record, double latency_ms) {
  ++frames_;
  latency_.add(latency_ms);
  cpu_.add(static_cast<double>(record.cpu_ns) * 1e-6);
  const TrackResult& result = record.result;
  if (!record.has_pose()) {
    ++lost_;
    const auto code = std::min(static_cast<std::size_t>(result.status.code()), kCodes - 1);
    ++reasons_[code];
    last_reason_[code] = result.status;
    return;
  }
  if (has_pose_) path_m_ += (result.T_world_camera.t - last_pose_.t).norm();
  has_pose_ = true;
  last_pose_ = result.T_world_camera;
  ++(result.state == TrackState::kInitialising ? initialised_ : tracked_);
}

std::string LiveSummary::main_reason() const {
  const auto most = std::max_element(reasons_.begin(), reasons_.end());
  return *most == 0 ? "" : last_reason_[static_cast<std::size_t>(most - reasons_.begin())].message();
}

std::string LiveSummary::to_text() const {
  std::string text = camera_name + '\n';
  const auto row = [&text](const char* name, const std::string& value) {
    fmt::format_to(std::back_inserter(text), "{:<22} {}\n", name, value);
  };
  const OpenNi2Counters& c = capture.camera;
  row("time", fmt::format("{:.1f} s{}", seconds, interrupted ? " (ended by a signal)" : ""));
  row("camera", fmt::format("{} frames, {:.1f} Hz", capture.frames, capture.average_hz));
  row("missing on the way", fmt::format("{} frames by their stamps", c.missing));
  row("odometry", fmt::format("{} frames; {} older ones dropped for newer ones", frames_, dropped));
  row("tracked", fmt::format("{}", tracked_ + initialised_));
  row("lost", fmt::format("{}", lost_));
  for (std::size_t i = 0; i < kCodes; ++i)
    if (reasons_[i] > 0) row(fmt::format("  {} times", reasons_[i]).c_str(), last_reason_[i].message());
  if (c.timeouts + c.unplugged + capture.damaged > 0)
    row("camera's troubles", fmt::format("{} timeouts, {} times unplugged, {} times back, {} damaged images",
                                         c.timeouts, c.unplugged, c.replugged, capture.damaged));
  row("path", fmt::format("{:.3f} m", path_m_));
  row("latency", fmt::format("{:.1f} ms median, {:.1f} p95, {:.1f} max, from frame to pose",
                             latency_.quantile_ms(0.5), latency_.quantile_ms(0.95), latency_.max_ms()));
  row("CPU per frame", fmt::format("{:.1f} ms median, {:.1f} p95, {:.1f} max", cpu_.quantile_ms(0.5),
                                   cpu_.quantile_ms(0.95), cpu_.max_ms()));
  row("memory",
      fmt::format("arena {:.2f} MiB; resident {:.2f} MiB after the start, {:.2f} at the end",
                  mebibytes(arena_bytes), mebibytes(resident_start.total), mebibytes(resident_end.total)));
  if (!recording.empty())
    row("recording",
        fmt::format(
            "{} frames in {}{}", recorded, recording,
            not_recorded > 0 ? fmt::format("; {} dropped, for the disk is too slow", not_recorded) : ""));
  if (dropped_lines > 0) row("stream", fmt::format("{} lines dropped for slow readers", dropped_lines));
  return text;
}

nlohmann::ordered_json LiveSummary::to_json() const {
  nlohmann::ordered_json json = {{"camera", camera_name},
                                 {"seconds", seconds},
                                 {"interrupted", interrupted},
                                 {"camera_frames", capture.frames},
                                 {"camera_hz", capture.average_hz},
                                 {"camera_state", capture.words},
                                 {"frames", frames_},
                                 {"initialised", initialised_},
                                 {"tracked", tracked_},
                                 {"lost", lost_},
                                 {"dropped", dropped},
                                 {"damaged", capture.damaged},
                                 {"path_m", path_m_}};
  json["lost_reasons"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kCodes; ++i)
    if (reasons_[i] > 0) json["lost_reasons"][to_string(static_cast<StatusCode>(i))] = reasons_[i];
  json["camera_counters"] = cli::to_json(capture.camera);
  json["latency_ms"] = cli::to_json(latency_);
  json["cpu_ms"] = cli::to_json(cpu_);
  json["recording"] = {{"path", recording}, {"frames", recorded}, {"dropped", not_recorded}};
  json["stream_dropped_lines"] = dropped_lines;
  json["memory_bytes"] = {{"arena", arena_bytes},
                          {"arena_peak", arena_peak},
                          {"resident_after_start", resident_start.total},
                          {"resident_at_end", resident_end.total},
                          {"anonymous_after_start", resident_start.anonymous},
                          {"anonymous_at_end", resident_end.anonymous}};
  return json;
}

}  // namespace plvo::cli
