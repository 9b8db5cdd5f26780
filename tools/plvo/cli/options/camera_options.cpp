// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/camera_options.hpp"

#include <fmt/core.h>

#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/bag_options.hpp"
#include "plvo/host/number_text.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/index/numbered_index.hpp"
#include "plvo/replay/wheel_files.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::cli {
namespace {

namespace fs = std::filesystem;

constexpr NumberRange kTolerance_s = positive(3600);
constexpr std::uint64_t kMostScale = 16;

SequenceOptions sequence_options(const CameraOptions& options) {
  SequenceOptions sequence;
  sequence.associations = options.associations;
  sequence.tolerance_ns = static_cast<std::int64_t>(options.tolerance_s * 1e9);
  sequence.frames_per_s = options.rate_hz;
  sequence.scale_down = options.scale;
  sequence.first_frame = options.frames.first;
  sequence.end_frame = options.frames.end;
  return sequence;
}

std::string sequence_name(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return (normal.filename().empty() ? normal.parent_path() : normal).filename().string();
}

// Where opening failed for a --scale that the images do not allow: wrong usage.
void refuse_scale(int scale, const WholeImage& whole, const Status& failure) {
  if (scale != 0 && whole.width > 0 && !check_reduction(scale, whole.width, whole.height).ok())
    refuse("--scale", failure.message());
}

Status open_recording(const CameraOptions& options, Log& log, OpenedCamera& opened) {
  const RecordingOptions how = {sequence_options(options), options.topics, options.calibration.depth_scale};
  const auto choose = [&options](const OwnCalibration& own, Calibration& calibration) {
    return find_calibration(options.calibration, own, calibration);
  };
  auto recording = std::make_shared<Recording>();
  const Status status = recording->open(options.sequence, choose, how);
  for (const std::string& sentence : recording->remarks()) log.write(LogLevel::kWarning, sentence);
  if (!status.ok()) {
    refuse_scale(options.scale, recording->whole_image(), status);
    return status;
  }
  for (const std::string& sentence : recording->calibration().assumptions())
    log.write(LogLevel::kWarning, sentence);
  opened.frame_count = recording->frame_count();
  opened.unpaired_images = recording->unpaired_colour();
  opened.scaled_down_by = recording->whole_image().factor;
  opened.name = sequence_name(options.sequence);
  if (recording->has_ground_truth())
    opened.ground_truth = [recording](const std::vector<std::int64_t>&, eval::Trajectory& truth) {
      return recording->read_true_poses(truth);
    };
  opened.true_poses_source = recording->true_poses_source();
  opened.wheels = [recording](const std::string& topic, WheelRecording& samples) {
    return recording->read_wheels(topic, samples);
  };
  opened.inertial = [recording](ImuRecording& samples) { return recording->read_imu(samples); };
  opened.camera = recording;
  return {};
}

Status open_simulator(const CameraOptions& options, OpenedCamera& opened) {
  SimulatorOptions settings;
  std::unique_ptr<SimulatedCamera> camera;
  const bool open_end = options.frames.end == FrameRange().end;
  const int frames = open_end ? kSimulatedFrames : static_cast<int>(options.frames.end);
  Status status = make_simulator_options(options.simulator, frames, settings);
  if (status.ok()) status = SimulatedCamera::create(settings, camera);
  if (!status.ok()) return status;
  opened.frame_count = static_cast<std::size_t>(camera->frames());
  opened.name =
      fmt::format("sim {} {} seed {}", to_string(settings.scene), to_string(settings.light), settings.seed);
  opened.ground_truth = [simulated = camera.get()](const std::vector<std::int64_t>& stamps,
                                                   eval::Trajectory& truth) {
    for (std::int64_t stamp : stamps) truth.poses.push_back({stamp, simulated->ground_truth(stamp)});
    return Status();
  };
  opened.inertial = [simulated = camera.get()](ImuRecording& recording) {
    simulated->inertial_samples(recording.gyro, recording.accelerometer);
    return Status();
  };
  opened.camera = std::move(camera);
  return {};
}

// The frames first … end-1 of a camera that cannot be told where to begin.
class CameraPart final : public RgbdCamera {
 public:
  CameraPart(std::unique_ptr<LiveCamera> camera, const FrameRange& range)
      : camera_(std::move(camera)), range_(range) {}
  ~CameraPart() { camera_->close(); }

  CameraModel model() const override { return camera_->model(); }
  Status next(RgbdFrame& frame) override {
    for (; number_ < range_.first; ++number_)
      if (Status status = camera_->next(frame); status.code() == StatusCode::kEndOfStream) return status;
    if (number_++ >= range_.end) return {StatusCode::kEndOfStream, "the chosen frames end here"};
    return camera_->next(frame);
  }

 private:
  std::unique_ptr<LiveCamera> camera_;
  FrameRange range_;
  std::size_t number_ = 0;
};

Status open_oni(const CameraOptions& options, Log& log, OpenedCamera& opened) {
  LiveCameraOptions live;
  live.device = options.sequence;
  live.calibration = options.calibration;
  std::unique_ptr<LiveCamera> camera;
  if (Status status = open_live_camera(live, log, camera); !status.ok()) return status;
  opened.name = sequence_name(options.sequence);
  opened.camera = std::make_unique<CameraPart>(std::move(camera), options.frames);
  return {};
}

}  // namespace

bool parse_frame_range(const std::string& text, FrameRange& range) {
  const std::size_t colon = text.find(':');
  const std::string_view all = text;
  const std::string_view first = colon == std::string::npos ? "" : all.substr(0, colon);
  const std::string_view end = colon == std::string::npos ? all : all.substr(colon + 1);
  FrameRange result;
  if (colon == std::string::npos && end.empty()) return false;
  if (!first.empty() && !parse_whole_text(first, result.first)) return false;
  if (!end.empty() && !parse_whole_text(end, result.end)) return false;
  if (result.first >= result.end) return false;
  range = result;
  return true;
}

CLI::Option* add_rate_option(OptionGroup& group, double& rate_hz) {
  return group.number("--rate", rate_hz, kNumberedRates_hz, "HZ",
                      "Numbered frames, which have no stamps: how many a second (default 30)");
}

void add_camera_options(CLI::App& command, CameraOptions& options) {
  OptionGroup group(command);
  group.path(
      "sequence", options.sequence,
      "What was recorded: a folder with rgb.txt and depth.txt (TUM layout) or with numbered frames "
      "(7-Scenes, ScanNet), an .oni file, or a recording of ROS: a .bag, an .mcap, a .db3, or a folder of "
      "rosbag2",
      "DIR|FILE");
  group.choice("--camera", options.simulated, Choices<bool>{{"sim", true}},
               "The simulated camera, instead of a recorded sequence");
  group.add("--frames", "N|FIRST:END",
            "Only the first N frames; or from FIRST (0 is the first) to before END",
            [&options](const std::string& text) -> std::string {
              if (parse_frame_range(text, options.frames)) return {};
              return expected("a number of frames such as 20, or a range such as 10:20, 50: or :20", text);
            });
  group.path("--associations", options.associations,
             "List of pairs 'stamp rgb_file stamp depth_file', instead of rgb.txt and depth.txt");
  group.number("--tolerance", options.tolerance_s, kTolerance_s, "SECONDS",
               "Colour and depth whose stamps differ by more are no pair (default 0.02)");
  add_rate_option(group, options.rate_hz);
  group.whole(
      "--scale", options.scale, 1, kMostScale,
      fmt::format(
          "Scale the images down by this factor, and the calibration, which is that of the whole images, "
          "with them: for less time a frame (default 1; images above {} pixels a side: as little as they "
          "need)",
          Limits::kMostSide));
  add_bag_options(command, options.topics, BagImu::kWithTruth);
  add_calibration_options(command, options.calibration, DepthScale::kAsked,
                          "the calibration in the recording");
  add_simulator_options(command, options.simulator);
}

void check_camera_options(const CLI::App& command, const CameraOptions& options) {
  check_calibration_options(command);
  if (options.simulated) {
    const char* why = "is for recorded sequences, not for the simulated camera";
    if (!options.sequence.empty())
      refuse("--camera", "sim and a recorded sequence (" + options.sequence + ") exclude each other");
    refuse_group(command, kCalibrationGroup, why);
    refuse_group(command, kBagGroup, why);
    refuse_options(command, {"--associations", "--tolerance", "--rate", "--scale"}, why);
    if (options.frames.first != 0)
      refuse("--frames", "a simulated sequence starts at frame 0: give the number of frames, such as 100");
    if (options.frames.end != FrameRange().end && options.frames.end > kMostSimulatedFrames)
      refuse("--frames", fmt::format("a simulated sequence has {} frames at most", kMostSimulatedFrames));
    return;
  }
  if (options.sequence.empty())
    refuse_command("a sequence is needed: plvo run DIR, plvo run FILE.oni or plvo run --camera sim");
  refuse_group(command, kSimulatorGroup, "is for the simulated camera: add --camera sim, or leave it out");
  if (is_bag(options.sequence))
    return refuse_options(command, {"--associations", "--rate"},
                          "does not apply to a ROS bag, which has pairs and stamps of its own");
  refuse_bag_options(command);
  if (is_oni_file(options.sequence)) {
    refuse_options(command, {"--scale"}, "is for folders of images, not for an .oni file");
    return refuse_options(command, {"--associations", "--tolerance", "--rate", "--depth-scale"},
                          "does not apply to an .oni file, which has pairs, stamps and units of its own");
  }
  if (options.associations.empty() && is_numbered_folder(options.sequence))
    return refuse_options(command, {"--tolerance"},
                          "does not apply to numbered frames: one number is a pair");
  refuse_options(command, {"--rate"}, "is for numbered frames; this sequence has stamps");
}

void add_inputs(const CameraOptions& options, FileRoles& files) {
  files.reads(options.calibration.file);
  files.reads(options.associations);
  files.reads(options.simulator.trajectory);
  if (options.simulated) return;
  if (is_bag(options.sequence)) files.reads(bag_ground_truth_file(options.sequence));
  for (const fs::path& file : bag_files_in(options.sequence)) files.reads(file);
  if (is_oni_file(options.sequence) || is_bag(options.sequence)) return files.reads(options.sequence);
  const fs::path folder = options.sequence;
  for (const char* name : {"rgb.txt", "depth.txt", "associations.txt", "groundtruth.txt", kGyroFile,
                           kAccelerometerFile, kWheelFile})
    files.reads(folder / name);
  for (const fs::path& file : calibration_files_in(folder)) files.reads(file);
  SequenceIndex index;
  if (!files.may_overwrite() || !read_sequence_index(folder, sequence_options(options), index).ok()) return;
  for (const ImagePair& pair : index.pairs) {
    files.reads(folder / pair.colour.file);
    files.reads(folder / pair.depth.file);
  }
  for (const StampedFile& pose : index.poses) files.reads(folder / pose.file);
}

Status open_camera(const CameraOptions& options, Log& log, OpenedCamera& opened) {
  if (options.simulated) return open_simulator(options, opened);
  return is_oni_file(options.sequence) ? open_oni(options, log, opened)
                                       : open_recording(options, log, opened);
}

}  // namespace plvo::cli
