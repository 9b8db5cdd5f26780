// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_outputs.hpp"

#include <fmt/format.h>

#include "plvo/host/posix_clock.hpp"
#include "plvo/host/stream/tcp_listener.hpp"

namespace plvo::cli {
namespace {

constexpr std::int64_t kStatusPeriod_ns = 250'000'000;

}  // namespace

Status LiveOutputs::listen(const LiveOutputOptions& options) {
  base_ = options.files.base;
  if (!options.view.empty())
    if (Status status = open_view(options.view, options.view_names); !status.ok()) return status;
  for (const std::string& address : options.streams)
    if (Status status = open_stream(address); !status.ok()) return status;
  return {};
}

Status LiveOutputs::open(const LiveOutputOptions& options, bool lens_is_straight) {
  lens_is_straight_ = lens_is_straight;
  warn_of_base_option(base_, console_);
  next_heartbeat_ns_ = posix_monotonic_ns() + kHeartbeat_ns;
  for (const auto& [level, sentence] : announcements_) console_.write(level, sentence);
  const OutputOptions& files = options.files;
  has_files_ = files.has_poses() || !files.stats.empty();
  return files_.open(files);
}

Status LiveOutputs::open_view(const std::string& address, const std::vector<std::string>& names) {
  std::string host;
  int port = 0;
  if (!split_address(address, host, port))
    return Status(StatusCode::kInvalidArgument, "a live view is at [ADDRESS:]PORT, not at '")
        .append(address)
        .append("'");
  view_ = std::make_unique<ViewServer>();
  map_way_.reserve(MapLimits::kMostKeyframes);
  if (Status status = view_->start(host, port, names); !status.ok()) return status;
  if (!is_loopback(host))
    announcements_.emplace_back(
        LogLevel::kWarning,
        "everybody who reaches this address can look through the camera; --view PORT alone stays on "
        "this machine");
  announcements_.emplace_back(LogLevel::kInfo,
                              fmt::format("live view: http://{}:{}/", with_brackets(host), view_->port()));
  return {};
}

Status LiveOutputs::open_stream(const std::string& address) {
  auto stream = std::make_unique<PoseStream>(base_.frames());
  if (Status status = stream->open(address); !status.ok()) return status;
  if (stream->port() != 0) {
    std::string host;
    int port = 0;
    split_address(address, host, port);
    if (!is_loopback(host))
      announcements_.emplace_back(LogLevel::kWarning,
                                  "everybody who reaches this address can read the poses");
    announcements_.emplace_back(LogLevel::kInfo,
                                fmt::format("poses: {}:{}", with_brackets(host), stream->port()));
  }
  streams_.push_back(std::move(stream));
  return {};
}

void LiveOutputs::write(const FrameRecord& record, const RgbdFrame& frame, const Odometry& odometry,
                        const SessionMap& map, const ViewStatus& status) {
  if (!files_end_) {
    if (const Status written = files_.write(record); !written.ok()) {
      files_end_ = true;
      failure_ = written;
      console_.write(LogLevel::kError,
                     fmt::format("{}; the files end here, the odometry goes on", written.message()));
    }
  }
  const TrackResult result = base_.apply(record.result);
  MapPose in_map;
  if (const std::optional<MapResult>& latest = map.latest())
    in_map = base_.apply(
        MapPose{latest->located, latest->T_map_world, latest->pose_covariance, map.map().counts().loops},
        record.result);
  to_streams([&](PoseStream& stream) { return stream.write(result, map.latest() ? &in_map : nullptr); });
  if (!view_) return;
  if (map.latest()) {
    map.way_in_world(map_way_);
    view_->publish_map_way(map_way_);
  }
  view_->publish(frame, odometry.features(), record.result, status, lens_is_straight_);
}

// Each stream gets a line; one that cannot go on is closed.
void LiveOutputs::to_streams(const std::function<Status(PoseStream&)>& write) {
  next_heartbeat_ns_ = posix_monotonic_ns() + kHeartbeat_ns;
  std::erase_if(streams_, [&](const std::unique_ptr<PoseStream>& stream) {
    const Status written = write(*stream);
    if (!written.ok()) {
      failure_ = written;
      console_.write(LogLevel::kError, written.message());
    }
    return !written.ok();
  });
}

void LiveOutputs::write_status(const ViewStatus& status, const Heartbeat& heartbeat) {
  const std::int64_t now = posix_monotonic_ns();
  if (now >= next_heartbeat_ns_) {
    to_streams([&](PoseStream& stream) { return stream.write_heartbeat(heartbeat); });
  }
  if (!view_ || now < next_status_ns_) return;
  next_status_ns_ = now + kStatusPeriod_ns;
  view_->publish_status(status);
}

void LiveOutputs::close() {
  for (const auto& stream : streams_) stream->close();
  if (view_) view_->stop();
}

std::uint64_t LiveOutputs::dropped_lines() const {
  std::uint64_t sum = 0;
  for (const auto& stream : streams_) sum += stream->dropped_lines();
  return sum;
}

}  // namespace plvo::cli
