// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "plvo/host/printable.hpp"

namespace plvo::cli {
namespace {

nlohmann::ordered_json counters_json(const OpenNi2Counters& c) {
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
  TrackSummary::add(record);
  latency_.add(latency_ms);
}

std::string LiveSummary::to_text() const {
  const OpenNi2Counters& c = capture.camera;
  SummaryRows rows = {
      {"time", fmt::format("{:.1f} s{}", seconds, interrupted ? " (ended by a signal)" : "")},
      {"camera", fmt::format("{} frames, {:.1f} Hz", capture.frames, capture.average_hz)},
      {"missing on the way", fmt::format("{} frames by their stamps", c.missing)},
      {"odometry", fmt::format("{} frames; {} older ones dropped for newer ones", frames(), dropped)}};
  const auto add = [&rows](const SummaryRows& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  add(frame_rows());
  if (c.timeouts + c.unplugged + capture.damaged > 0)
    rows.emplace_back("camera's troubles",
                      fmt::format("{} timeouts, {} times unplugged, {} times back, {} damaged images",
                                  c.timeouts, c.unplugged, c.replugged, capture.damaged));
  rows.emplace_back("latency",
                    fmt::format("{:.1f} ms median, {:.1f} p95, {:.1f} max, from frame to pose",
                                latency_.quantile_ms(0.5), latency_.quantile_ms(0.95), latency_.max_ms()));
  add(cost_rows());
  if (map) add(map->rows());
  if (!recording.empty())
    rows.emplace_back(
        "recording",
        fmt::format(
            "{} frames in {}{}", recorded, recording,
            not_recorded > 0 ? fmt::format("; {} dropped, because the disk is too slow", not_recorded) : ""));
  if (accelerometer.used)
    rows.emplace_back("accelerometer",
                      fmt::format("{} readings, {} left out as late, {} failures", accelerometer.readings,
                                  accelerometer.late, accelerometer.failures));
  if (wheels.used)
    rows.emplace_back("wheels", fmt::format("{} lines, {} left out; {} frames with them, {} without",
                                            wheels.lines, wheels.left_out, wheels.with, wheels.without));
  if (dropped_lines > 0)
    rows.emplace_back("stream", fmt::format("{} lines dropped for slow readers", dropped_lines));
  return printable(camera_name) + '\n' + cli::to_text(rows) + stage_table();
}

nlohmann::ordered_json LiveSummary::to_json() const {
  nlohmann::ordered_json json = TrackSummary::to_json();
  json["damaged"] = capture.damaged;
  json["seconds"] = seconds;
  json["dropped"] = dropped;
  json["camera_frames"] = capture.frames;
  json["camera_hz"] = capture.average_hz;
  json["camera_state"] = capture.words;
  json["camera_counters"] = counters_json(capture.camera);
  json["latency_ms"] = cli::to_json(latency_);
  json["recording"] = {{"path", recording}, {"frames", recorded}, {"dropped", not_recorded}};
  json["stream_dropped_lines"] = dropped_lines;
  if (accelerometer.used)
    json["accelerometer"] = {{"readings", accelerometer.readings},
                             {"late", accelerometer.late},
                             {"failures", accelerometer.failures}};
  if (wheels.used)
    json["wheels"] = {{"lines", wheels.lines},
                      {"left_out", wheels.left_out},
                      {"frames_with", wheels.with},
                      {"frames_without", wheels.without}};
  if (map) json["map"] = map->to_json();
  return json;
}

}  // namespace plvo::cli
