// SPDX-License-Identifier: Apache-2.0
// A live session: one thread captures, this one tracks. Between them lies a ring of fixed size in which the
// newest frame wins, so that the pose is always about now; what the odometry had no time for is counted.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "plvo/cli/live/live_accelerometer.hpp"
#include "plvo/cli/live/live_capture.hpp"
#include "plvo/cli/live/live_outputs.hpp"
#include "plvo/cli/live/live_summary.hpp"
#include "plvo/cli/live/live_wheels.hpp"
#include "plvo/cli/map/session_map.hpp"
#include "plvo/cli/options/odometry_options.hpp"

namespace plvo::cli {

struct LiveOptions {
  LiveCameraOptions camera;
  OdometryOptions odometry;
  LiveOutputOptions outputs;
  MapOptions map;
  std::string summary;  // file for the JSON
  std::string record;   // folder or .oni
  std::uint64_t frames = std::numeric_limits<std::uint64_t>::max();
  double seconds = std::numeric_limits<double>::infinity();
  double max_rate_hz = 0;    // 0: as they come
  bool every_frame = false;  // the camera waits for the odometry
  bool imu = false;          // a Kinect's accelerometer
  WheelOptions wheels;
  bool quiet = false;
};

class LiveSession {
 public:
  explicit LiveSession(const LiveOptions& options)
      : options_(options),
        console_(options.quiet),
        outputs_(console_),
        accelerometer_(console_),
        wheels_(console_) {}

  // From opening the camera to the exit code.
  int run();

 private:
  Status prepare_outputs();
  Status open();
  int refused(const Status& status, int exit_code);
  void loop();
  bool keeps_imu() const;
  bool keeps_wheels() const;
  bool over() const;
  bool wait_for_turn();
  void handle(const RgbdFrame& frame, std::int64_t arrival_ns);
  void tell_status();
  ViewStatus view_status() const;
  void show_line(const ViewStatus& status, const TrackResult& result);
  void finish();
  int judge();

  LiveOptions options_;
  Console console_;
  LiveOutputs outputs_;
  std::unique_ptr<LiveCamera> camera_;
  std::unique_ptr<FrameRing> ring_;
  FrameRecording recording_;
  std::unique_ptr<LiveCapture> capture_;
  OdometryBlock block_;
  SessionMap map_;
  LiveAccelerometer accelerometer_;
  LiveWheels wheels_;
  LiveSummary summary_;
  RateMeter meter_;
  FrameRecord record_;
  double latency_ms_ = 0;
  std::int64_t start_ns_ = 0;
  std::int64_t next_turn_ns_ = 0;
  Status recorder_failure_, summary_failure_;
};

}  // namespace plvo::cli
