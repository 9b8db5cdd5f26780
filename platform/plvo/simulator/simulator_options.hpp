// SPDX-License-Identifier: Apache-2.0
// Options of a simulated camera. The defaults are those of the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/difficulties.hpp"

namespace plvo {

enum class SceneName : std::uint8_t { kCorridor, kStaircase, kHall, kDesk, kBare };
enum class LightName : std::uint8_t {
  kConstant,  // the ceiling lights
  kVarying,   // a hand-held panel lamp that swings and dims; the ceiling lights are nearly off
};

// "corridor", "staircase", "hall", "desk", "bare"; "constant", "varying".
const char* to_string(SceneName name);
const char* to_string(LightName name);
// Return kInvalidArgument with the list of known names for any other text.
Status parse_scene(std::string_view text, SceneName& name);
Status parse_light(std::string_view text, LightName& name);

// The Kinect's depth sensor: a projector beside an infrared camera.
struct DepthSensorOptions {
  DepthNoise noise;           // equation (2)
  double noise_scale = 0.55;  // noise of the real sensor relative to (2); see kinect_depth.hpp
  double min_range_m = 0.5;   // no depth below this
  double max_range_m = 5.0;   // no depth beyond this
  double baseline_m = 0.075;  // from the infrared camera to the projector, along +x
  double focal_px = 580;      // focal length of the infrared camera
  double steps_per_px = 8;    // disparity steps per pixel; 0: no quantisation
  double scale_error = 1;     // reported depth over true depth
};

// Exposure times and stamps of the depth images. By default depth and colour are exposed together.
struct DepthSchedule {
  double delay_s = 0;               // exposure of the middle row minus the stamp; may be negative
  std::optional<double> readout_s;  // time from the first row to the last; none: that of the colour image
  double stamp_offset_s = 0;        // depth stamp minus colour stamp, at most half a frame
  // Depth images per second, at least the rate of the colour images. The depth camera then runs on its own
  // clock, starting at stamp_offset_s, and each colour image is paired with the nearest depth image. None:
  // one clock for both.
  std::optional<double> fps;
  double stamp_jitter_s = 0;  // standard deviation of the stamp; does not affect the exposure
};

// A gyro and an accelerometer beside the camera, sampled together; the model is an MPU-6050. The noise is
// that of the data sheet (0.005 °/s/√Hz, 400 µg/√Hz). The SD of the accelerometer's offset is half the
// tolerance of the data sheet (±50 mg). The gyro's offset tolerance is ±20 °/s; after a calibration at rest
// about 1 °/s remains as the sensor warms up.
struct InertialOptions {
  double rate_hz = 200;
  double gyro_noise = 8.7e-5;                // rad/s/√Hz
  double gyro_offset_sigma = 0.0175;         // rad/s, per axis; drawn once from the seed
  double accelerometer_noise = 3.9e-3;       // m/s²/√Hz
  double accelerometer_offset_sigma = 0.25;  // m/s², per axis; drawn once from the seed
};

// The wheel odometry of a robot (SimulatorOptions::robot). Errors as of a small indoor robot after
// calibration.
struct SimulatedWheels {
  double rate_hz = 50;
  double noise_mps = 0.005, noise_rps = 0.01;                // white, of each sample
  double speed_scale_sigma = 0.02, turn_scale_sigma = 0.03;  // drawn once from the seed
  double slip_share = 0.1;  // of the half seconds in which the wheels of one side slip
  double slip = 0.2;        // by this share of the speed
  double track_m = 0.4;     // between the wheels of both sides
};

// T_base_camera of the simulated robot: 0.2 m ahead of the base and 0.5 m above it, level, looking ahead.
Se3 robot_camera();

struct SimulatorOptions {
  SceneName scene = SceneName::kCorridor;
  LightName light = LightName::kConstant;
  std::uint64_t seed = 1;
  // Rooms of the same plan and paint, with the same trajectory, that differ in grain, wear and prints.
  std::uint32_t storey = 0;
  int frames = 300;
  double fps = 30;
  CameraModel camera;
  // false: the same trajectory under the same light without colour noise and blur, and with the exact depth
  // of every surface within the range of the 16-bit format (13.1 m).
  bool noise = true;
  DepthSensorOptions depth;
  DepthSchedule depth_schedule;
  InertialOptions inertial;
  // Frames covered_first … covered_end − 1 are black and have no depth, as with a hand over the lens.
  int covered_first = 0, covered_end = 0;
  // A TUM ground-truth file with the trajectory of the camera; empty: a trajectory generated from the seed.
  std::string trajectory_file;
  bool still = false;  // the camera stays at its first pose
  // The camera stands on a robot: it keeps its height and stays level, but for the rumble of the floor.
  bool robot = false;
  SimulatedWheels wheels;
  Difficulties difficulties;
  int threads = 2;  // the images do not depend on it

  // Returns kInvalidArgument with the name of the option for a value out of range.
  Status validate() const;
};

}  // namespace plvo
