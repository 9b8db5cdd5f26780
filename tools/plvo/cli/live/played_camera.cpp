// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/played_camera.hpp"

#include <algorithm>
#include <utility>

#include "plvo/cli/common/interrupt.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/replay/paced_camera.hpp"

namespace plvo::cli {
namespace {

class PlayedCamera final : public LiveCamera {
 public:
  PlayedCamera(std::string name, OpenedCamera opened) : name_(std::move(name)), opened_(std::move(opened)) {}

  CameraModel model() const override { return opened_.camera->model(); }
  Status next(RgbdFrame& frame) override {
    const Status status = opened_.camera->next(frame);
    counters_.frames += status.ok() ? 1 : 0;
    counters_.damaged += status.code() == StatusCode::kDamaged ? 1 : 0;
    return status;
  }
  std::string name() const override { return name_; }
  OpenNi2Counters counters() const override { return counters_; }
  bool registered_by_device() const override { return true; }
  void close() override {}
  Status read_imu(ImuRecording& recording) override { return opened_.inertial(recording); }
  Status read_wheels(const std::string& topic, WheelRecording& recording) override {
    return opened_.wheels(topic, recording);
  }
  Status read_true_poses(eval::Trajectory& poses, std::string& source) override {
    if (!opened_.ground_truth) return {StatusCode::kNotFound, "the recording has no true poses"};
    source = opened_.true_poses_source;
    return opened_.ground_truth({}, poses);
  }

  Status start_oni(const std::string&) override {
    return {StatusCode::kUnsupported, "OpenNI2 does not play bags: make a folder of it instead"};
  }
  Status poll_oni() override { return {}; }
  void stop_oni() override {}

 private:
  std::string name_;
  OpenedCamera opened_;
  OpenNi2Counters counters_;
};

// Looks every tenth of a second whether a signal came: a recording may have a gap of minutes.
class PatientClock final : public Clock {
 public:
  std::int64_t monotonic_ns() const override { return clock_.monotonic_ns(); }
  void sleep_until_ns(std::int64_t until_ns) override {
    constexpr std::int64_t kSlice_ns = 100'000'000;
    for (std::int64_t now = monotonic_ns(); now < until_ns && !interrupted(); now = monotonic_ns())
      clock_.sleep_until_ns(std::min(until_ns, now + kSlice_ns));
  }

 private:
  PosixClock clock_;
};

class CameraAtOwnPace final : public LiveCamera {
 public:
  explicit CameraAtOwnPace(std::unique_ptr<LiveCamera> camera)
      : camera_(std::move(camera)), paced_(*camera_, Pace::kRealtime, clock_, nullptr) {}

  CameraModel model() const override { return camera_->model(); }
  Status next(RgbdFrame& frame) override { return paced_.next(frame); }
  std::string name() const override { return camera_->name(); }
  std::string uri() const override { return camera_->uri(); }
  OpenNi2Counters counters() const override { return camera_->counters(); }
  bool registered_by_device() const override { return camera_->registered_by_device(); }
  Status read_imu(ImuRecording& recording) override { return camera_->read_imu(recording); }
  Status read_wheels(const std::string& topic, WheelRecording& recording) override {
    return camera_->read_wheels(topic, recording);
  }
  Status read_true_poses(eval::Trajectory& poses, std::string& source) override {
    return camera_->read_true_poses(poses, source);
  }
  void close() override { camera_->close(); }
  Status start_oni(const std::string& path) override { return camera_->start_oni(path); }
  Status poll_oni() override { return camera_->poll_oni(); }
  void stop_oni() override { camera_->stop_oni(); }

 private:
  std::unique_ptr<LiveCamera> camera_;
  PatientClock clock_;
  PacedCamera paced_;
};

}  // namespace

Status open_played_camera(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera) {
  CameraOptions played;
  played.simulated = options.simulated;
  played.simulator = options.simulator;
  if (options.simulated) played.frames.end = static_cast<std::size_t>(options.simulated_frames);
  played.sequence = options.device;
  played.topics = options.topics;
  played.calibration = options.calibration;
  OpenedCamera opened;
  if (Status status = open_camera(played, log, opened); !status.ok()) return status;
  const std::string name = options.simulated ? opened.name : options.device;
  camera = std::make_unique<PlayedCamera>(name, std::move(opened));
  return {};
}

std::unique_ptr<LiveCamera> at_own_pace(std::unique_ptr<LiveCamera> camera) {
  return std::make_unique<CameraAtOwnPace>(std::move(camera));
}

}  // namespace plvo::cli
