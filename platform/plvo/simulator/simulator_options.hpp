// SPDX-License-Identifier: Apache-2.0
// What a simulated camera can be asked for. The defaults are those of the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/depth_noise.hpp"

namespace plvo {

enum class SceneName : std::uint8_t { kCorridor, kStaircase, kHall, kDesk, kBare };
enum class LightName : std::uint8_t {
  kConstant,  // the ceiling lights
  kVarying,   // a panel lamp in a hand: it swings and dims; the ceiling lights are nearly off
};

// "corridor", "staircase", "hall", "desk", "bare"; "constant", "varying".
const char* to_string(SceneName name);
const char* to_string(LightName name);
// kInvalidArgument, listing the names there are.
Status parse_scene(std::string_view text, SceneName& name);
Status parse_light(std::string_view text, LightName& name);

// The Kinect's depth sensor: a projector beside an infrared camera.
struct DepthSensorOptions {
  DepthNoise noise;           // equation (2)
  double noise_scale = 0.55;  // the real sensor's share of (2); see kinect_depth.hpp
  double min_range_m = 0.5;   // nearer is a hole
  double max_range_m = 5.0;   // farther is a hole
  double baseline_m = 0.075;  // from the infrared camera to the projector, along +x
  double focal_px = 580;      // of the infrared camera
  double steps_per_px = 8;    // disparity steps per pixel; 0: no quantisation
  double scale_error = 1;     // reported depth over true depth
};

// When the depth images are exposed and what stamps they bear. By default depth is taken when colour is.
struct DepthSchedule {
  double delay_s = 0;  // the middle row is exposed this long after the stamp; negative: before it
  std::optional<double> readout_s;  // from the first row to the last; none: that of the colour image
  double stamp_offset_s = 0;        // of the depth stamp from the colour stamp, at most half a frame
  // Of depth images a second, at least those of colour: the depth camera runs on its own clock, from
  // stamp_offset_s on, and each colour image goes with the nearest depth image. None: one clock.
  std::optional<double> fps;
  double stamp_jitter_s = 0;  // standard deviation of the stamp; the exposure keeps its moment
};

// A gyro and an accelerometer beside the camera, sampled together: an MPU-6050. The noise is that of its data
// sheet (0.005 °/s/√Hz, 400 µg/√Hz); so is half the tolerance of its accelerometer's offset (±50 mg). Of the
// gyro's, ±20 °/s, a calibration at rest leaves about 1 °/s as the part warms up.
struct InertialOptions {
  double rate_hz = 200;
  double gyro_noise = 8.7e-5;                // rad/s/√Hz
  double gyro_offset_sigma = 0.0175;         // rad/s, of each axis; drawn once from the seed
  double accelerometer_noise = 3.9e-3;       // m/s²/√Hz
  double accelerometer_offset_sigma = 0.25;  // m/s², of each axis; drawn once from the seed
};

struct SimulatorOptions {
  SceneName scene = SceneName::kCorridor;
  LightName light = LightName::kConstant;
  std::uint64_t seed = 1;
  int frames = 300;
  double fps = 30;
  CameraModel camera;
  // false: the noise-free twin of the same walk under the same light: no colour noise, no blur, and the exact
  // depth of every surface within the range of the 16-bit format (13.1 m).
  bool noise = true;
  DepthSensorOptions depth;
  DepthSchedule depth_schedule;
  InertialOptions inertial;
  // Frames covered_first … covered_end − 1 are black and without depth: a hand over the lens.
  int covered_first = 0, covered_end = 0;
  // A TUM ground-truth file that moves the camera instead of the seeded hand; empty: none.
  std::string trajectory_file;
  int threads = 2;  // the pictures do not depend on it

  // kInvalidArgument, naming the option.
  Status validate() const;
};

}  // namespace plvo
