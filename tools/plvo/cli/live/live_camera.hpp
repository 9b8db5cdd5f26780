// SPDX-License-Identifier: Apache-2.0
// The sensor that `plvo live`, `record` and `doctor` read, as the command line names it, or a file in its
// place, and its recorder for .oni files. One thread at a time may use it.
#pragma once

#include <memory>
#include <string>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/cli/options/camera_options.hpp"
#include "plvo/hal/log.hpp"
#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/openni2/openni2_camera.hpp"
#include "plvo/replay/paced_camera.hpp"

namespace plvo::cli {

struct LiveCameraOptions {
  std::string device;  // an OpenNI2 URI, an .oni file or a recording of ROS; empty: the first sensor
  bool simulated = false;
  SimulatorArguments simulator;
  int simulated_frames = 1800;  // a minute
  Pace pace = Pace::kFast;      // of what is played instead of a sensor
  std::string mode = "640x480@30";
  BagTopicNames topics;
  CalibrationOptions calibration;
};
enum class PlayedFiles : std::uint8_t { kOni, kOniAndBags };  // in the place of a sensor
void add_live_camera_options(CLI::App& command, LiveCameraOptions& options, PlayedFiles files);
// The simulated camera in the place of a sensor, and the pace of what is played.
void add_played_camera_options(CLI::App& command, LiveCameraOptions& options);
// Refuses what does not apply to the device that was named.
void check_live_camera_options(const CLI::App& command, const LiveCameraOptions& options);
void add_inputs(const LiveCameraOptions& options, FileRoles& files);

// When a session ends by itself.
void add_limit_options(CLI::App& command, std::uint64_t& frames, double& seconds);
inline constexpr NumberRange kSeconds = positive(1e8);  // three years

struct VideoMode {
  int width = 0, height = 0, fps = 30;
};
// "WIDTHxHEIGHT" or "WIDTHxHEIGHT@FPS".
bool parse_video_mode(const std::string& text, VideoMode& mode);

bool is_oni_file(const std::string& path);
// An .oni file or a ROS bag instead of a sensor: every frame of it is wanted, and it waits for whoever reads.
bool is_recorded_device(const std::string& path);

// A recording, or the simulated camera.
bool is_played(const LiveCameraOptions& options);

class LiveCamera : public RgbdCamera {
 public:
  virtual ~LiveCamera() = default;
  virtual std::string name() const = 0;           // for people: "Virtual RGB-D (virtual://plvo)"
  virtual std::string uri() const { return {}; }  // of a sensor
  virtual OpenNi2Counters counters() const = 0;
  virtual bool registered_by_device() const = 0;
  // What a recording has of a gyro and an accelerometer.
  virtual Status read_imu(ImuRecording&) { return {StatusCode::kNotFound, "the camera is not a recording"}; }
  virtual Status read_wheels(const std::string&, WheelRecording&) {
    return {StatusCode::kNotFound, "the camera is not a recording"};
  }
  // The true poses of a recording of ROS, and where they were: a topic, or the name of a file. kNotFound
  // without.
  virtual Status read_true_poses(eval::Trajectory&, std::string&) {
    return {StatusCode::kNotFound, "the camera is not a recording"};
  }
  // Ends an .oni recording, too. What was asked for above can still be asked.
  virtual void close() = 0;

  // Recording what comes into an .oni file. poll() now and then: kIo when the disk is about to be full and
  // kUnplugged after an unplug; the file is complete in both cases.
  virtual Status start_oni(const std::string& path) = 0;
  virtual Status poll_oni() = 0;
  virtual void stop_oni() = 0;
};

// kUnsupported, naming the package, where plvo was built without OpenNI2. `log` must outlive the camera.
Status open_live_camera(const LiveCameraOptions& options, Log& log, std::unique_ptr<LiveCamera>& camera);
Status list_live_cameras(std::vector<OpenNi2DeviceInfo>& devices);

// How a command ends that a camera refused: kExitNoSensor when there is none to be had, else kExitFailure.
int exit_code_of_camera(const Status& status, const std::string& device);

}  // namespace plvo::cli
