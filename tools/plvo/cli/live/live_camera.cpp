// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_camera.hpp"

#include <fmt/format.h>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/live/played_camera.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/host/number_text.hpp"
#include "plvo/recording/foreign_format.hpp"
#include "plvo/replay/checks/calibration_check.hpp"
#include "plvo/replay/images/registered_camera.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"

#ifdef PLVO_HAVE_OPENNI2
#include "plvo/openni2/openni2_recorder.hpp"
#endif

namespace plvo::cli {
namespace {

bool parse_positive(std::string_view text, int& value) {
  return parse_whole_text(text, value) && value > 0 && value <= 10000;
}

}  // namespace

void add_live_camera_options(CLI::App& command, LiveCameraOptions& options, PlayedFiles files) {
  const bool bags = files == PlayedFiles::kOniAndBags;
  OptionGroup group(command);
  group.path(
      "--device", options.device,
      fmt::format("A sensor by its OpenNI2 URI (plvo doctor lists them){} an .oni file{} (default: the "
                  "first sensor)",
                  bags ? "," : ", or", bags ? " or a recording of ROS" : ""),
      bags ? "URI|FILE" : "URI|FILE.oni");
  group.add("--mode", "WIDTHxHEIGHT@FPS",
            "Size and rate of colour and depth, such as 640x480@30 (default), 320x240@30 or 320x240@60",
            [&options](const std::string& text) -> std::string {
              VideoMode mode;
              options.mode = text;
              return parse_video_mode(text, mode) ? ""
                                                  : expected("WIDTHxHEIGHT@FPS, such as 640x480@30", text);
            });
  add_calibration_options(command, options.calibration, DepthScale::kFromCamera,
                          "the field of view that the sensor states, with a warning");
}

void add_played_camera_options(CLI::App& command, LiveCameraOptions& options) {
  OptionGroup group(command);
  group.choice("--camera", options.simulated, Choices<bool>{{"sim", true}},
               "The simulated camera, instead of a sensor: a sequence of a minute, or of --frames N");
  options.pace = Pace::kRealtime;
  group.choice("--pace", options.pace, Choices<Pace>{{"fast", Pace::kFast}, {"realtime", Pace::kRealtime}},
               "Of a recording and the simulated camera: as the stamps say (default), or as fast as it goes");
  add_simulator_options(command, options.simulator);
}

void check_live_camera_options(const CLI::App& command, const LiveCameraOptions& options) {
  check_calibration_options(command);
  if (options.simulated) {
    const char* why = "is for a sensor or a recording, not for the simulated camera";
    refuse_options(command, {"--device", "--mode"}, why);
    refuse_group(command, kCalibrationGroup, why);
    refuse_group(command, kBagGroup, why);
    return;
  }
  refuse_group(command, kSimulatorGroup, "is for the simulated camera: add --camera sim, or leave it out");
  if (!is_played(options))
    refuse_options(command, {"--pace"}, "is for a recording or the simulated camera; a sensor has its own");
  if (is_recorded_device(options.device))
    refuse_options(command, {"--mode"},
                   "does not apply to a recording, which has a size and a rate of its own");
  if (!is_bag(options.device)) refuse_bag_options(command);
}

void add_inputs(const LiveCameraOptions& options, FileRoles& files) {
  files.reads(options.calibration.file);
  files.reads(options.simulator.trajectory);
  if (is_recorded_device(options.device)) files.reads(options.device);
  for (const std::filesystem::path& file : bag_files_in(options.device)) files.reads(file);
}

void add_limit_options(CLI::App& command, std::uint64_t& frames, double& seconds) {
  OptionGroup group(command);
  group.whole("--frames", frames, 1, 1'000'000'000, "Only the first N frames");
  group.number("--seconds", seconds, kSeconds, "SECONDS", "Only so long");
}

bool parse_video_mode(const std::string& text, VideoMode& mode) {
  const std::string_view all = text;
  const std::size_t cross = all.find('x');
  const std::size_t at = all.find('@');
  if (cross == std::string_view::npos || (at != std::string_view::npos && at < cross)) return false;
  VideoMode result;
  const std::size_t height_length = at == std::string_view::npos ? at : at - cross - 1;
  if (!parse_positive(all.substr(0, cross), result.width) ||
      !parse_positive(all.substr(cross + 1, height_length), result.height) ||
      (at != std::string_view::npos && !parse_positive(all.substr(at + 1), result.fps)))
    return false;
  mode = result;
  return true;
}

bool is_oni_file(const std::string& path) { return path.ends_with(".oni"); }
bool is_recorded_device(const std::string& path) { return is_oni_file(path) || is_bag(path); }
bool is_played(const LiveCameraOptions& options) {
  return options.simulated || is_recorded_device(options.device);
}

int exit_code_of_camera(const Status& status, const std::string& device) {
  switch (status.code()) {
    case StatusCode::kNotFound: return is_recorded_device(device) ? kExitFailure : kExitNoSensor;
    case StatusCode::kPermission:
    case StatusCode::kBusy:
    case StatusCode::kTimeout:
    case StatusCode::kUnplugged: return kExitNoSensor;
    default: return kExitFailure;
  }
}

#ifdef PLVO_HAVE_OPENNI2
namespace {

// The readout alone goes with the field of view that the sensor states.
bool calibration_given(const CalibrationOptions& o) {
  return !o.file.empty() || !o.model_name.empty() || o.fx || o.fy || o.cx || o.cy || !o.distortion.empty();
}

class OpenNi2LiveCamera final : public LiveCamera {
 public:
  // depth: the depth camera, where its images are registered here and not by the device.
  Status open(const OpenNi2Options& options, const DepthCamera& depth = {}) {
    if (Status status = camera_.open(options); !status.ok() || !depth.known) return status;
    if (camera_.registered_by_device())
      return {StatusCode::kInvalidArgument,
              "this sensor or .oni file has registered depth: leave depth_fx, depth_fy and what goes with "
              "them out of the calibration"};
    registered_.emplace(camera_, depth);
    return {};
  }

  CameraModel model() const override { return camera_.model(); }
  Status next(RgbdFrame& frame) override {
    return registered_ ? registered_->next(frame) : camera_.next(frame);
  }
  std::string uri() const override { return camera_.device().uri; }
  std::string name() const override {
    const OpenNi2DeviceInfo info = camera_.device();
    return is_oni_file(info.uri) ? info.uri : fmt::format("{} ({})", info.name, info.uri);
  }
  OpenNi2Counters counters() const override { return camera_.counters(); }
  bool registered_by_device() const override { return camera_.registered_by_device(); }

  void close() override {
    stop_oni();
    camera_.close();
  }

  Status start_oni(const std::string& path) override {
    wanted_ = true;
    return recorder_.start(camera_, path);
  }
  Status poll_oni() override {
    if (!wanted_) return {};
    Status status = recorder_.check();
    if (status.ok() && !recorder_.recording())
      status = {StatusCode::kUnplugged,
                "the sensor was unplugged, which ends an .oni recording; it is complete so far"};
    if (!status.ok()) wanted_ = false;
    return status;
  }
  void stop_oni() override {
    wanted_ = false;
    recorder_.stop();
  }

 private:
  OpenNi2Camera camera_;
  std::optional<RegisteredCamera> registered_;
  OpenNi2Recorder recorder_;
  bool wanted_ = false;
};

// The user's calibration for images of this size.
Status calibrate(const CalibrationOptions& from, int width, int height, std::optional<CameraModel>& model,
                 DepthCamera& depth) {
  if (!calibration_given(from)) return {};
  Calibration calibration;
  const auto none = [](Calibration&) { return Status(StatusCode::kNotFound, "no recording"); };
  Status status = find_calibration(from, none, calibration);
  if (status.ok()) status = calibration.validate(width, height);
  // A file that is not there is no missing sensor.
  if (!status.ok()) return {StatusCode::kInvalidArgument, status.message()};
  calibration.camera.width = width;
  calibration.camera.height = height;
  model = calibration.camera;
  depth = calibration.depth_camera;
  return {};
}

Status open_sensor(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera) {
  VideoMode mode;
  if (!parse_video_mode(options.mode, mode)) return {StatusCode::kInvalidArgument, "not a video mode"};
  OpenNi2Options settings;
  settings.uri = options.device;
  settings.log = &log;
  auto opened = std::make_unique<OpenNi2LiveCamera>();
  if (is_oni_file(options.device) && calibration_given(options.calibration)) {
    // A recording has a size of its own, which the calibration must fit.
    OpenNi2Options look = settings;
    look.log = nullptr;
    if (Status status = opened->open(look); !status.ok()) return status;
    mode = {opened->model().width, opened->model().height, mode.fps};
  }
  settings.width = mode.width;
  settings.height = mode.height;
  settings.fps = mode.fps;
  settings.readout_s = options.calibration.readout_s;
  DepthCamera depth;
  Status status = calibrate(options.calibration, mode.width, mode.height, settings.model, depth);
  if (status.ok() && settings.model)
    for (const std::string& sentence : doubts_about(*settings.model, mode.width, mode.height))
      log.write(LogLevel::kWarning, sentence);
  if (depth.known) settings.registration = OpenNi2Registration::kNone;
  if (status.ok()) status = opened->open(settings, depth);
  if (status.ok()) camera = std::move(opened);
  return status;
}

}  // namespace

Status list_live_cameras(std::vector<OpenNi2DeviceInfo>& devices) { return OpenNi2Camera::list(devices); }

#else

namespace {

Status not_built() {
  return {
      StatusCode::kUnsupported,
      "this plvo was built without live sensors: sudo apt install libopenni2-dev, then configure and build "
      "again"};
}

Status open_sensor(const LiveCameraOptions&, Log&, std::unique_ptr<LiveCamera>&) { return not_built(); }

}  // namespace

Status list_live_cameras(std::vector<OpenNi2DeviceInfo>&) { return not_built(); }

#endif

Status open_live_camera(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera) {
  if (Status status = refuse_foreign_format(options.device); !status.ok()) return status;
  if (options.simulated || is_bag(options.device)) return open_played_camera(options, log, camera);
  return open_sensor(options, log, camera);
}

}  // namespace plvo::cli
