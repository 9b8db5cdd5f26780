// SPDX-License-Identifier: Apache-2.0
// plvo record: what a sensor sees, kept for later. plvo convert: the same of a recording.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/interrupt.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/live/live_accelerometer.hpp"
#include "plvo/cli/live/live_capture.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/wheel_files.hpp"

namespace plvo::cli {
namespace {

constexpr int kRingPatience_ms = 100;
constexpr const char* kTruthFile = "groundtruth.txt";
constexpr const char* kRecordHelp =
    "Examples:\n"
    "  plvo record sequence                         a new folder with PNG images; then: plvo run sequence\n"
    "  plvo record recording.oni --seconds 60       one file of OpenNI2; then: plvo run recording.oni\n"
    "  plvo record sequence --device recording.oni  the one from the other; plvo convert does the same\n"
    "\n"
    "Ctrl-C ends, and so does a full disk: what was written is whole and can be read.\n";

constexpr const char* kConvertHelp =
    "Examples:\n"
    "  plvo convert recording.mcap --out sequence         a new folder with PNG images, for plvo run\n"
    "  plvo convert recording.bag --out sequence --imu    with gyro and accelerometer\n"
    "\n"
    "The true poses of a recording of ROS become groundtruth.txt. plvo run reads such recordings as\n"
    "they are: convert makes folders for other programs.\n";

constexpr const char* kImuText =
    "Keep accelerometer.txt and gyroscope.txt, too: of a Kinect v1's accelerometer, or of the recording of "
    "ROS";
constexpr const char* kQuietText = "Warnings and errors only: no progress, no summary";

struct RecordOptions {
  LiveCameraOptions camera;
  std::string path;
  std::uint64_t frames = std::numeric_limits<std::uint64_t>::max();
  double seconds = std::numeric_limits<double>::infinity();
  bool imu = false;
  std::string wheels_topic;
  bool quiet = false;
};

void show_line(Console& console, const LiveCapture::State& state, const FrameRecording& recording) {
  std::string line = fmt::format("recorded {}  camera {:.1f} Hz  dropped {}", recording.frames(), state.hz,
                                 recording.dropped());
  if (!state.last.ok()) line += "  " + state.words;
  console.show_line(line);
}

int judge(const RecordOptions& options, const LiveCapture::State& state, const Status& stopped,
          const LiveAccelerometer& accelerometer) {
  if (!state.end.ok()) {
    fail(state.end);
    return exit_code_of_camera(state.end, options.camera.device);
  }
  if (!state.recorder.ok()) return exit_code_of_camera(state.recorder, {});
  if (!stopped.ok()) return fail(stopped);
  if (!accelerometer.failure().ok()) return kExitFailure;  // which was told
  if (state.frames > 0) return kExitSuccess;
  fail(fmt::format("no frame came: {}; plvo doctor looks into it", state.words));
  return kExitNoSensor;
}

// What can be wrong with the outputs is found before a sensor is opened.
Status check_outputs(const RecordOptions& options) {
  Status status = FrameRecording::check(options.path);
  if (status.ok() && options.imu) status = refuse_imu_files(options.path);
  std::vector<const char*> names;
  if (is_bag(options.camera.device)) names.push_back(kTruthFile);
  if (!options.wheels_topic.empty()) names.push_back(kWheelFile);
  std::error_code error;
  for (std::size_t i = 0; status.ok() && i < names.size(); ++i)
    if (std::filesystem::exists(std::filesystem::path(options.path) / names[i], error))
      return {StatusCode::kInvalidArgument,
              fmt::format("{} has {} already: remove it or choose another folder", options.path, names[i])};
  return status;
}

// What a recording of ROS has beside the images.
struct BesideImages {
  ImuRecording imu;
  WheelRecording wheels;
  eval::Trajectory truth;
  std::string truth_source;  // empty: there is no truth
};

// There is no truth if it cannot be read, which is told, or if it is the topic of the wheels.
void take_true_poses(const RecordOptions& options, LiveCamera& camera, Log& log, BesideImages& beside) {
  const Status status = camera.read_true_poses(beside.truth, beside.truth_source);
  if (!status.ok() || beside.truth_source == options.wheels_topic) beside.truth_source.clear();
  if (!status.ok() && status.code() != StatusCode::kNotFound)
    log.write(LogLevel::kWarning, fmt::format("no groundtruth.txt is written: {}", status.message()));
}

// All that a recording has, before anything is made.
Status read_beside_images(const RecordOptions& options, LiveCamera& camera, Log& log, BesideImages& beside) {
  if (!is_bag(options.camera.device)) return {};
  Status status;
  if (options.imu) status = camera.read_imu(beside.imu);
  if (status.ok() && !options.wheels_topic.empty())
    status = camera.read_wheels(options.wheels_topic, beside.wheels);
  if (!status.ok()) return status;
  if (beside.wheels.ignored > 0)
    log.write(LogLevel::kWarning,
              fmt::format("{} messages on {} left out: damaged, not finite, or with a repeated stamp",
                          beside.wheels.ignored, options.wheels_topic));
  take_true_poses(options, camera, log, beside);
  return {};
}

Status write_true_poses(const std::string& folder, const BesideImages& beside) {
  LineFile file;
  Status status = file.open(std::filesystem::path(folder) / kTruthFile,
                            fmt::format("{}; from {}", kTrajectoryHeader, printable(beside.truth_source)));
  for (std::size_t i = 0; status.ok() && i < beside.truth.poses.size(); ++i)
    status =
        file.write(trajectory_line(beside.truth.poses[i].stamp_ns, beside.truth.poses[i].T_world_camera));
  return status;
}

Status write_beside_images(const RecordOptions& options, const BesideImages& beside) {
  Status status;
  if (options.imu) status = write_imu_files(options.path, beside.imu, ImuAxes::kSensor);
  if (status.ok() && !options.wheels_topic.empty())
    status = write_wheel_file(std::filesystem::path(options.path) / kWheelFile, beside.wheels);
  if (status.ok() && !beside.truth_source.empty()) status = write_true_poses(options.path, beside);
  return status;
}

// Begins to write the readings of other sensors, from the live sensor or from the recording.
Status begin_beside_images(const RecordOptions& options, const LiveCamera& camera, const BesideImages& beside,
                           LiveAccelerometer& accelerometer) {
  if (is_bag(options.camera.device)) return write_beside_images(options, beside);
  if (!options.imu) return {};
  accelerometer.keep_in(options.path);
  return accelerometer.start(camera, false);
}

int record_command(const RecordOptions& options) {
  Console console(options.quiet);
  if (Status status = check_outputs(options); !status.ok()) return fail(status);
  std::unique_ptr<LiveCamera> camera;
  if (Status status = open_live_camera(options.camera, console, camera); !status.ok()) {
    fail(status);
    return exit_code_of_camera(status, options.camera.device);
  }
  // Here the ring only says that frames come: the recording has one of its own.
  const CameraModel model = camera->model();
  FrameRing ring(model.width, model.height, 3, RingPolicy::kNewest);
  BesideImages beside;
  FrameRecording recording;
  LiveAccelerometer accelerometer(console);
  Status begun = read_beside_images(options, *camera, console, beside);
  catch_interrupt();  // from here on there is something to keep whole
  if (begun.ok())
    begun = recording.open(options.path, *camera, is_recorded_device(options.camera.device), options.frames);
  if (begun.ok()) begun = begin_beside_images(options, *camera, beside, accelerometer);
  if (!begun.ok()) return fail(begun);
  console.write(LogLevel::kInfo, fmt::format("{}, {}x{}, into {}; Ctrl-C ends", camera->name(), model.width,
                                             model.height, options.path));
  LiveCapture capture(*camera, Pace::kFast, ring, recording, console);
  const std::int64_t start_ns = posix_monotonic_ns();
  const auto seconds = [start_ns] { return static_cast<double>(posix_monotonic_ns() - start_ns) * 1e-9; };
  capture.start();
  RgbdFrame frame;
  std::int64_t arrival_ns = 0;
  while (!interrupted() && seconds() < options.seconds) {
    const FrameRing::Take take = ring.take(frame, arrival_ns, kRingPatience_ms);
    if (take == FrameRing::Take::kClosed) break;
    if (take == FrameRing::Take::kFrame) (void)accelerometer.until(frame.stamp_ns, arrival_ns);
    const LiveCapture::State state = capture.state();
    if (state.frames >= options.frames || !state.recorder.ok()) break;
    if (console.wants_line()) show_line(console, state, recording);
  }
  capture.stop();
  accelerometer.stop();
  const Status stopped = recording.stop();
  console.clear();
  const LiveCapture::State state = capture.state();
  if (!options.quiet) {
    std::string text =
        fmt::format("{} frames in {} ({:.1f} s{})", recording.frames(), printable(options.path), seconds(),
                    interrupted() ? ", ended by a signal" : "");
    if (recording.dropped() > 0)
      text += fmt::format(
          "; {} dropped, because the disk or the processor is too slow: try --mode 320x240 or an .oni file",
          recording.dropped());
    if (!beside.truth_source.empty())
      text += fmt::format("; {} true poses of {} in {}", beside.truth.poses.size(),
                          printable(beside.truth_source), kTruthFile);
    if (Status status = print(text + fmt::format("; next: plvo run {}\n", printable(options.path)));
        !status.ok())
      return fail(status);
  }
  return judge(options, state, stopped, accelerometer);
}

void check(const CLI::App& command, const RecordOptions& options) {
  check_live_camera_options(command, options.camera);
  FileRoles files;
  if (is_oni_file(options.path)) {
    refuse_group(
        command, kCalibrationGroup,
        "would be lost, because an .oni file keeps no calibration: give it to plvo run FILE.oni instead");
    refuse_options(command, {"--imu"}, "an .oni file keeps no readings of it; record a folder instead");
    if (is_bag(options.camera.device)) refuse("path", "a ROS bag is kept as a folder, not as an .oni file");
    files.writes("path", options.path);
  } else {
    for (const char* name :
         {"rgb.txt", "depth.txt", "calibration.txt", kTruthFile, kGyroFile, kAccelerometerFile, kWheelFile})
      files.writes(given(command, "--out") ? "--out" : "path", std::filesystem::path(options.path) / name);
  }
  if (is_oni_file(options.camera.device))
    refuse_options(command, {"--imu"}, "does not apply to an .oni file, which holds no such readings");
  if (!options.imu)
    refuse_options(command, {"--gyro-topic", "--accelerometer-topic"},
                   "is for --imu: add it, or leave this out");
  add_inputs(options.camera, files);
  files.check();
}

}  // namespace

void add_record(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App& command =
      add_command(app, "record", "Keep what a sensor sees, as a folder or an .oni file", kRecordHelp);
  OptionGroup group(command);
  require(group.path("path", options->path, "A new folder (rgb.txt, depth.txt, PNG), or a new .oni file",
                     "DIR|FILE.oni"));
  add_live_camera_options(command, options->camera, PlayedFiles::kOniAndBags);
  group.flag("--imu", options->imu, kImuText);
  add_limit_options(command, options->frames, options->seconds);
  add_bag_options(command, options->camera.topics, BagImu::kWithTruth);
  group.flag("--quiet", options->quiet, kQuietText);
  on_command(command, exit_code, [&command, options] {
    check(command, *options);
    return record_command(*options);
  });
}

void add_convert(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App& command = add_command(app, "convert", "Make a folder of images of a recording", kConvertHelp);
  OptionGroup group(command);
  require(group.path("recording", options->camera.device,
                     "A recording of ROS (a .bag, an .mcap, a .db3, or a folder of rosbag2), or an .oni file",
                     "DIR|FILE"));
  require(group.path("--out", options->path, "A new folder for the sequence", "DIR"));
  group.flag("--imu", options->imu, kImuText);
  group.path("--wheels-topic", options->wheels_topic,
             "Write wheel_odometry.txt, too: the twist of the nav_msgs/Odometry on this topic, which is that "
             "of the wheels",
             "TOPIC");
  add_limit_options(command, options->frames, options->seconds);
  add_calibration_options(command, options->camera.calibration, DepthScale::kFromCamera,
                          "the calibration in the recording");
  add_bag_options(command, options->camera.topics, BagImu::kWithTruth);
  group.flag("--quiet", options->quiet, kQuietText);
  on_command(command, exit_code, [&command, options] {
    if (!is_recorded_device(options->camera.device))
      refuse("recording", "is no recording of ROS and no .oni file; a folder of images needs no conversion");
    if (!options->wheels_topic.empty() && is_oni_file(options->camera.device))
      refuse("--wheels-topic", "is for a recording of ROS");
    if (is_oni_file(options->path)) refuse("--out", "is a folder, not an .oni file");
    check(command, *options);
    return record_command(*options);
  });
}

}  // namespace plvo::cli
