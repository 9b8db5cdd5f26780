// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/played_camera.hpp"

#include <utility>

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

}  // namespace plvo::cli
