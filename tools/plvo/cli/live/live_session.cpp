// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/result_output.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/standard_streams.hpp"
#include "plvo/replay/imu_files.hpp"

namespace plvo::cli {
namespace {

constexpr std::size_t kSlots = 4;          // one written, one read, one ready, and one to spare
constexpr int kPatience_ms = 100;          // so often Ctrl-C and the limits are looked at
constexpr std::uint64_t kWarmFrames = 30;  // the libraries have taken their memory by then

}  // namespace

int LiveSession::run() {
  if (const Status status = prepare_outputs(); !status.ok()) return refused(status, kExitFailure);
  if (const Status status = open_live_camera(options_.camera, console_, camera_); !status.ok())
    return refused(status, exit_code_of_camera(status, options_.camera.device));
  catch_interrupt();  // from here on there is something to keep whole
  if (const Status status = open(); !status.ok()) return refused(status, kExitFailure);
  loop();
  finish();
  return judge();
}

int LiveSession::refused(const Status& status, int exit_code) {
  console_.clear();
  fail(status);
  return exit_code;
}

// What can be wrong with the outputs is found before a sensor is opened. Addresses are taken, files are only
// tried: without a sensor an old trajectory must stay.
Status LiveSession::prepare_outputs() {
  if (!options_.summary.empty())
    if (Status status = LineFile::check(options_.summary); !status.ok()) return status;
  for (const auto& [option, path] : options_.outputs.files.named())
    if (!path.empty())
      if (Status status = LineFile::check(path); !status.ok()) return status;
  if (Status status = SessionMap::check_outputs(options_.map); !status.ok()) return status;
  if (!options_.record.empty()) {
    if (Status status = FrameRecording::check(options_.record); !status.ok()) return status;
    if (keeps_imu())
      if (Status status = refuse_imu_files(options_.record); !status.ok()) return status;
    if (keeps_wheels())
      if (Status status = refuse_wheel_file(options_.record); !status.ok()) return status;
  }
  return outputs_.listen(options_.outputs);
}

bool LiveSession::keeps_imu() const {
  return options_.imu && !options_.record.empty() && !is_oni_file(options_.record);
}

bool LiveSession::keeps_wheels() const {
  return !options_.wheels.file.empty() && !options_.record.empty() && !is_oni_file(options_.record);
}

// Everything else that can be wrong is found before the first file is made.
Status LiveSession::open() {
  const bool every = options_.every_frame || is_played(options_.camera);
  const CameraModel model = camera_->model();
  if (Status status = block_.init(model, options_.odometry); !status.ok()) return status;
  if (Status status = map_.init(options_.map, model, block_.config(), false); !status.ok()) return status;
  const WheelClock wheel_clock = is_played(options_.camera) ? WheelClock::kImages : WheelClock::kComputer;
  if (Status status = wheels_.start(options_.wheels, options_.outputs.files.base, wheel_clock); !status.ok())
    return status;
  if (keeps_wheels()) wheels_.keep_in(options_.record);
  ring_ = std::make_unique<FrameRing>(model.width, model.height, kSlots,
                                      every ? RingPolicy::kEvery : RingPolicy::kNewest);
  if (Status status = outputs_.open(options_.outputs, model.distortion.is_zero()); !status.ok())
    return status;
  if (!options_.record.empty())
    if (Status status = recording_.open(options_.record, *camera_, every); !status.ok()) return status;
  if (options_.imu) {
    if (keeps_imu()) accelerometer_.keep_in(options_.record);
    if (Status status = accelerometer_.start(*camera_, options_.odometry.level_world); !status.ok())
      return status;
  }
  summary_.camera_name = camera_->name();
  summary_.recording = options_.record;
  const Pace pace = is_played(options_.camera) ? options_.camera.pace : Pace::kFast;
  capture_ = std::make_unique<LiveCapture>(*camera_, pace, *ring_, recording_, console_);
  prefault_program();
  console_.write(LogLevel::kInfo,
                 fmt::format("{}, {}x{}; Ctrl-C ends", summary_.camera_name, model.width, model.height));
  return {};
}

bool LiveSession::over() const {
  return interrupted() || (outputs_.in_vain() && !recording_.wanted() && !map_.writes()) ||
         summary_.frames() >= options_.frames ||
         static_cast<double>(posix_monotonic_ns() - start_ns_) * 1e-9 >= options_.seconds;
}

void LiveSession::loop() {
  start_ns_ = posix_monotonic_ns();
  capture_->start();
  RgbdFrame frame;
  std::int64_t arrival_ns = 0;
  while (!over()) {
    if (!wait_for_turn()) {
      tell_status();
      continue;
    }
    const FrameRing::Take take = ring_->take(frame, arrival_ns, kPatience_ms);
    if (take == FrameRing::Take::kClosed) return;
    if (take == FrameRing::Take::kFrame) handle(frame, arrival_ns);
    if (take == FrameRing::Take::kTimeout) tell_status();
    if (console_.wants_line()) show_line(view_status(), record_.result);
  }
}

// False, after a short sleep, while the chosen rate says that it is too early for the next frame.
bool LiveSession::wait_for_turn() {
  if (options_.max_rate_hz <= 0) return true;
  const std::int64_t now = posix_monotonic_ns();
  if (now < next_turn_ns_) {
    std::this_thread::sleep_for(
        std::chrono::nanoseconds(std::min<std::int64_t>(next_turn_ns_ - now, kPatience_ms * 1'000'000)));
    return false;
  }
  return true;
}

void LiveSession::handle(const RgbdFrame& frame, std::int64_t arrival_ns) {
  if (options_.max_rate_hz > 0)
    next_turn_ns_ =
        std::max(next_turn_ns_ + static_cast<std::int64_t>(1e9 / options_.max_rate_hz), posix_monotonic_ns());
  block_.track(frame, accelerometer_.until(frame.stamp_ns, arrival_ns),
               wheels_.until(frame.stamp_ns, arrival_ns), record_);
  map_.add(block_.odometry(), record_);
  const std::int64_t now = posix_monotonic_ns();
  meter_.tick(now);
  latency_ms_ = static_cast<double>(now - arrival_ns) * 1e-6;
  summary_.add(record_, latency_ms_);
  outputs_.write(record_, frame, block_.odometry(), map_, view_status());
  ++record_.number;
  if (summary_.frames() == kWarmFrames) summary_.resident_start = resident_memory();
}

// What is said while there is no pose to tell.
void LiveSession::tell_status() {
  const LiveCapture::State capture = capture_->state();
  wheels_.while_no_frame_comes();
  outputs_.write_status(view_status(), {capture.word(), capture.seconds_since_frame, capture.words});
}

ViewStatus LiveSession::view_status() const {
  const LiveCapture::State capture = capture_->state();
  ViewStatus status;
  status.silent = !capture.last.ok() || capture.frames == 0;
  status.camera = status.silent ? capture.words : "camera ok";
  status.camera_hz = capture.hz;
  status.odometry_hz = meter_.hz(posix_monotonic_ns());
  status.latency_ms = latency_ms_;
  status.frames = summary_.frames();
  status.lost = summary_.lost();
  status.dropped = ring_->counters().dropped;
  if (map_.latest()) status.map = {map_.latest()->located, map_.map().counts().loops};
  return status;
}

void LiveSession::show_line(const ViewStatus& status, const TrackResult& result) {
  std::string line = fmt::format(
      "{}  camera {:.1f} Hz  odometry {:.1f} Hz  latency {:.0f} ms  points {}  lines {}  lost {}  dropped {}",
      summary_.frames() > 0 ? to_string(result.state) : "waiting", status.camera_hz, status.odometry_hz,
      status.latency_ms, result.points.inliers, result.lines.inliers, status.lost, status.dropped);
  if (status.map)
    line += fmt::format("  {}, loops {}", status.map->located ? "located" : "not located", status.map->loops);
  if (recording_.wanted()) line += fmt::format("  recorded {}", recording_.frames());
  if (status.silent) line += "  " + status.camera;
  console_.show_line(line);
}

void LiveSession::finish() {
  capture_->stop();
  accelerometer_.stop();
  recorder_failure_ = recording_.stop();
  if (!recorder_failure_.ok()) console_.write(LogLevel::kError, recorder_failure_.message());
  outputs_.close();
  map_.finish();
  console_.clear();
  if (summary_.frames() < kWarmFrames) summary_.resident_start = resident_memory();
  summary_.resident_end = resident_memory();
  summary_.seconds = static_cast<double>(posix_monotonic_ns() - start_ns_) * 1e-9;
  summary_.interrupted = interrupted();
  summary_.warnings = console_.warnings();
  summary_.capture = capture_->state();
  summary_.accelerometer = accelerometer_.summary();
  summary_.wheels = wheels_.summary();
  summary_.dropped = ring_->counters().dropped;
  summary_.recorded = recording_.frames();
  summary_.not_recorded = recording_.dropped();
  summary_.map = map_.summary();
  summary_.dropped_lines = outputs_.dropped_lines();
  summary_.arena_bytes = block_.odometry().memory_used();
  summary_.arena_peak = block_.odometry().memory_peak();
  if (options_.quiet) return;
  const OutputOptions& files = options_.outputs.files;
  const MapOptions& map = options_.map;
  std::vector<std::string> paths = options_.outputs.streams;
  paths.insert(paths.end(), {files.trajectory, files.covariance, files.motions, files.stats, options_.summary,
                             map.trajectory, map.ply, map.out});
  if (takes_standard_output(paths)) {
    print_to_stderr(summary_.to_text());
  } else {
    summary_failure_ = print(summary_.to_text());
  }
}

int LiveSession::judge() {
  const Status mapped = map_.write();
  if (!mapped.ok()) fail(mapped);
  if (!options_.summary.empty()) {
    if (Status status = write_json(options_.summary, summary_.to_json()); !status.ok()) return fail(status);
  }
  std::vector<std::string> written = {options_.record, options_.summary};
  for (const auto& [option, path] : options_.outputs.files.named()) written.push_back(path);
  if (mapped.ok())
    written.insert(written.end(), {options_.map.out, options_.map.trajectory, options_.map.ply});
  tell_written(console_, written);
  if (!summary_failure_.ok()) return fail(summary_failure_);
  const LiveCapture::State& capture = summary_.capture;
  if (!capture.end.ok()) {
    fail(capture.end);
    return exit_code_of_camera(capture.end, options_.camera.device);
  }
  for (const Status& told :
       {outputs_.failure(), capture.recorder, recorder_failure_, accelerometer_.failure(), wheels_.failure()})
    if (!told.ok()) return kExitFailure;
  if (capture.frames == 0) {
    fail(fmt::format("no frame came from {}: {}; plvo doctor looks into it", summary_.camera_name,
                     capture.words));
    return kExitNoSensor;
  }
  if (!mapped.ok()) return kExitFailure;
  if (!summary_.failed()) return kExitSuccess;
  fail(summary_.why_failed());
  return kExitNothingTracked;
}

}  // namespace plvo::cli
