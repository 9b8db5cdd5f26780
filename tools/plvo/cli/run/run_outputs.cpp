// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/run/run_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/stream/tcp_listener.hpp"

namespace plvo::cli {
namespace {

// RFC 4180: quotes inside are doubled.
std::string csv_quoted(std::string_view text) {
  std::string result = "\"";
  for (char c : text) {
    if (c == '"') result += c;
    result += c;
  }
  return result + '"';
}

void append_counts(std::string& row, const FeatureCounts& c) {
  fmt::format_to(std::back_inserter(row), ",{},{},{},{},{}", c.detected, c.dropped, c.with_depth, c.matched,
                 c.inliers);
}

}  // namespace

void add_output_options(CLI::App& command, OutputOptions& options) {
  OptionGroup group(command, kOutputGroup);
  group.path("--out", options.trajectory, "Trajectory, TUM format: a line for each frame that has a pose");
  group.path("--covariance", options.covariance, "6x6 covariance of each pose");
  group.path("--motions", options.motions,
             "Motion from the reference of each frame, with its 6x6 covariance");
  group.path("--stats", options.stats, "CSV: a row for each frame, lost and damaged ones with the reason");
  group.add("--mavlink", "[HOST:]PORT",
            "MAVLink's ODOMETRY of the robot's base to an autopilot, over UDP; needs --base-camera",
            [&options](const std::string& text) -> std::string {
              std::string host;
              int port = 0;
              options.mavlink = text;
              return split_address(text, host, port) && port > 0
                         ? ""
                         : expected("[HOST:]PORT, such as 127.0.0.1:14550", text);
            });
  add_base_option(group, options.base);
}

void check_output_options(const CLI::App& command) {
  if (!given(command, "--base-camera"))
    refuse_options(
        command, {"--mavlink"},
        "is of the robot's base: add --base-camera (0 0 0 -0.5 0.5 -0.5 0.5 for a camera that looks "
        "ahead)");
}

bool takes_standard_output(const std::vector<std::string>& paths) {
  return std::any_of(paths.begin(), paths.end(),
                     [](const std::string& path) { return is_standard_output(path); });
}

Status RunOutputs::open(const OutputOptions& options) {
  Status status;
  base_ = options.base;
  const FrameNames& frames = base_.frames();
  if (!options.trajectory.empty()) status = trajectory_.open(options.trajectory, frames);
  if (status.ok() && !options.covariance.empty()) status = covariance_.open(options.covariance, frames);
  if (status.ok() && !options.motions.empty()) status = motions_.open(options.motions, frames);
  if (status.ok() && !options.mavlink.empty()) status = mavlink_.open(options.mavlink);
  if (status.ok() && !options.stats.empty()) status = stats_.open(options.stats, stats_header());
  return status;
}

Status RunOutputs::write(const FrameRecord& record) {
  Status status;
  if (!record.damaged()) {
    const TrackResult result = base_.apply(record.result);
    status = trajectory_.write(result);
    if (status.ok()) status = covariance_.write(result);
    if (status.ok()) status = motions_.write(result);
    if (status.ok()) status = mavlink_.write(result);
  }
  return status.ok() ? stats_.write(stats_row(record)) : status;
}

std::string stats_header() {
  std::string header = "frame,timestamp,state,reason,reference_timestamp,brightness";
  for (const char* kind : {"points", "lines"})
    for (const char* count : {"detected", "dropped", "with_depth", "matched", "inliers"})
      fmt::format_to(std::back_inserter(header), ",{}_{}", kind, count);
  header += ",ransac_iterations,lm_iterations,disagreement";
  for (int i = 0; i < kStageCount; ++i)
    fmt::format_to(std::back_inserter(header), ",{}_ms", to_string(static_cast<Stage>(i)));
  return header + ",total_ms";
}

std::string stats_row(const FrameRecord& record) {
  const TrackResult& result = record.result;
  const Status& status = record.damaged() ? record.camera_status : result.status;
  std::string row = fmt::format("{},{},{},{},{},{:.2f}", record.number, format_stamp(result.stamp_ns),
                                record.damaged() ? "damaged" : to_string(result.state),
                                csv_quoted(printable(status.message())),
                                format_stamp(result.reference_stamp_ns), result.mean_brightness);
  append_counts(row, result.points);
  append_counts(row, result.lines);
  fmt::format_to(std::back_inserter(row), ",{},{},{:.2f}", result.ransac_iterations, result.lm_iterations,
                 result.disagreement);
  for (std::int64_t ns : result.stage_ns)
    fmt::format_to(std::back_inserter(row), ",{:.4f}", static_cast<double>(ns) * 1e-6);
  fmt::format_to(std::back_inserter(row), ",{:.4f}", static_cast<double>(record.cpu_ns) * 1e-6);
  return row;
}

}  // namespace plvo::cli
