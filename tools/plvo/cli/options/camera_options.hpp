// SPDX-License-Identifier: Apache-2.0
// Which camera the frames come from, and how it is calibrated: the options that say so, and what they open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/file_roles.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/simulator_arguments.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/hal/log.hpp"
#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/image_reduction.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/index/sequence_index.hpp"
#include "plvo/replay/wheel_files.hpp"
#include "plvo/rosbag/bag_topics.hpp"

namespace plvo::cli {

struct CalibrationOptions {
  std::string file, model_name;
  std::optional<double> fx, fy, cx, cy, depth_scale, readout_s, stamp_sigma_s;
  std::vector<double> distortion;  // of the lens distortion_model (plvo/camera/camera_info.hpp)
  std::string distortion_model;
};
inline constexpr const char* kCalibrationGroup = "Calibration";
// The depth scale is asked for only where it is not the camera's own. fallback: what holds without
// any of them.
enum class DepthScale : std::uint8_t { kAsked, kFromCamera };
void add_calibration_options(CLI::App& command, CalibrationOptions& options, DepthScale depth_scale,
                             const std::string& fallback);
// Refuses what contradicts itself.
void check_calibration_options(const CLI::App& command);

// What the flags say; without any of them that says all, the recording's own. kInvalidArgument, naming the
// ways to give one, where `own` says kNotFound.
Status find_calibration(const CalibrationOptions& options, const std::function<Status(Calibration&)>& own,
                        Calibration& calibration);

struct FrameRange {
  std::size_t first = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();  // exclusive
};
// "b": the first b frames; "a:b", "a:", ":b": frames a … b-1.
bool parse_frame_range(const std::string& text, FrameRange& range);

// Frame rates that numbered frames may have; with these their stamps stay within 64 bits.
inline constexpr NumberRange kNumberedRates_hz = {0.1, 1000};
CLI::Option* add_rate_option(OptionGroup& group, double& rate_hz);

struct CameraOptions {
  bool simulated = false;
  std::string sequence;  // a folder, an .oni file or a recording of ROS, where it is not simulated
  FrameRange frames;
  std::string associations;
  double tolerance_s = 0.02;
  double rate_hz = SequenceOptions().frames_per_s;
  int scale = SequenceOptions().scale_down;
  BagTopicNames topics;
  CalibrationOptions calibration;
  SimulatorArguments simulator;
};
void add_camera_options(CLI::App& command, CameraOptions& options);
// Refuses a command line without a sequence or with two, and options that do not apply to the one it names.
void check_camera_options(const CLI::App& command, const CameraOptions& options);
// The files that open_camera() and the camera read.
void add_inputs(const CameraOptions& options, FileRoles& files);

struct OpenedCamera {
  std::shared_ptr<RgbdCamera> camera;      // not unique: it deletes the class that it was made with
  std::string name;                        // for people
  std::optional<std::size_t> frame_count;  // where it is known
  std::size_t unpaired_images = 0;         // colour images without depth
  int scaled_down_by = 1;                  // the images
  // The true poses, where there are any: from a file beside the images, or from the simulator
  // at these stamps.
  std::function<Status(const std::vector<std::int64_t>& stamps_ns, eval::Trajectory& truth)> ground_truth;
  std::string true_poses_source;  // of a recording: a topic, or the name of a file
  // The odometry of wheels on a topic; empty where there can be none.
  std::function<Status(const std::string& topic, WheelRecording& recording)> wheels;
  // What a gyro and an accelerometer beside the camera read; empty where there can be none.
  std::function<Status(ImuRecording& recording)> inertial;
};
// log: for what the camera has to say; it must outlive the camera.
Status open_camera(const CameraOptions& options, Log& log, OpenedCamera& opened);

}  // namespace plvo::cli
