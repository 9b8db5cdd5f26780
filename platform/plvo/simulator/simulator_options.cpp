// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/simulator_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace plvo {
namespace {

constexpr std::array kScenes = {SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall,
                                SceneName::kDesk, SceneName::kBare};
constexpr std::array kLights = {LightName::kConstant, LightName::kVarying};

template <typename Name, std::size_t N>
Status parse(std::string_view what, std::string_view text, const std::array<Name, N>& names, Name& name) {
  for (const Name candidate : names) {
    if (text == to_string(candidate)) {
      name = candidate;
      return {};
    }
  }
  Status status(StatusCode::kInvalidArgument, "there is no ");
  status.append(what).append(" \"").append(text.substr(0, 40)).append("\"; choose one of:");
  for (const Name candidate : names) status.append(" ").append(to_string(candidate));
  return status;
}

Status invalid(const char* what) { return Status(StatusCode::kInvalidArgument, "simulator: ").append(what); }

Status validate_timing(const DepthSchedule& timing, double colour_fps) {
  if (!(std::abs(timing.delay_s) <= 0.1)) return invalid("the depth delay must lie in -0.1 ... 0.1 seconds");
  if (timing.readout_s && !(*timing.readout_s >= 0 && *timing.readout_s <= 0.1))
    return invalid("the depth readout must lie in 0 ... 0.1 seconds");
  if (!(std::abs(timing.stamp_offset_s) <= 0.5 / colour_fps))
    return invalid("the depth stamp offset must be at most half a frame: another frame would be nearer");
  if (timing.fps && !(*timing.fps >= colour_fps && *timing.fps <= 1000))
    return invalid("the depth camera must take at least as many images per second as the colour camera");
  // The noise is at most 4.9 standard deviations, so stamps keep their order.
  if (!(timing.stamp_jitter_s >= 0 && timing.stamp_jitter_s <= 0.1 / timing.fps.value_or(colour_fps)))
    return invalid("the jitter of the depth stamps must be at most a tenth of a frame");
  return {};
}

}  // namespace

const char* to_string(SceneName name) {
  switch (name) {
    case SceneName::kCorridor: return "corridor";
    case SceneName::kStaircase: return "staircase";
    case SceneName::kHall: return "hall";
    case SceneName::kDesk: return "desk";
    case SceneName::kBare: return "bare";
  }
  return "unknown";
}

const char* to_string(LightName name) {
  switch (name) {
    case LightName::kConstant: return "constant";
    case LightName::kVarying: return "varying";
  }
  return "unknown";
}

Status parse_scene(std::string_view text, SceneName& name) { return parse("scene", text, kScenes, name); }
Status parse_light(std::string_view text, LightName& name) { return parse("light", text, kLights, name); }

Se3 robot_camera() {
  Matrix3 R_body_optical;
  R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {R_body_optical, {0.2, 0, 0.5}};
}

Status SimulatorOptions::validate() const {
  const Status calibration = camera.validate();
  if (!calibration.ok()) return calibration;
  if (camera.width > 4096 || camera.height > 4096)
    return invalid("the image may have at most 4096x4096 pixels");
  if (frames < 1 || frames > 1000000) return invalid("frames must lie in 1 ... 1000000");
  if (!(fps >= 1 && fps <= 1000)) return invalid("fps must lie in 1 ... 1000");
  if (threads < 1 || threads > 256) return invalid("threads must lie in 1 ... 256");
  if (!(depth.noise_scale >= 0 && depth.noise_scale <= 100))
    return invalid("the depth noise scale must lie in 0 ... 100");
  if (!(depth.min_range_m >= 0 && depth.max_range_m > depth.min_range_m && depth.max_range_m <= 13))
    return invalid("the depth range must be 0 <= min < max <= 13 metres");
  if (!(depth.baseline_m > 0 && depth.baseline_m < 1))
    return invalid("the baseline must lie in 0 ... 1 metre");
  if (!(depth.focal_px > 0 && depth.focal_px < 1e5))
    return invalid("the infrared focal length must be positive");
  if (!(depth.steps_per_px >= 0 && depth.steps_per_px < 1e4))
    return invalid("steps per pixel must lie in 0 ... 10000");
  if (!(depth.scale_error >= 0.5 && depth.scale_error <= 2))
    return invalid("the depth scale error is a factor: it must lie in 0.5 ... 2");
  if (covered_first < 0 || covered_end < covered_first)
    return invalid("the covered frames must be a range that starts at 0 or later");
  if (!(inertial.rate_hz >= 10 && inertial.rate_hz <= 10000))
    return invalid("the rate of gyro and accelerometer must lie in 10 ... 10000 Hz");
  const double largest = std::max({inertial.gyro_noise, inertial.gyro_offset_sigma,
                                   inertial.accelerometer_noise, inertial.accelerometer_offset_sigma});
  const double smallest = std::min({inertial.gyro_noise, inertial.gyro_offset_sigma,
                                    inertial.accelerometer_noise, inertial.accelerometer_offset_sigma});
  if (!(smallest >= 0 && largest <= 10))
    return invalid("noise and offsets of gyro and accelerometer must lie in 0 ... 10");
  if (!(wheels.rate_hz >= 5 && wheels.rate_hz <= 1000))
    return invalid("the rate of the wheels must lie in 5 ... 1000 Hz");
  if (robot && !trajectory_file.empty())
    return invalid("a robot drives the scene's own path, not a recorded trajectory");
  if (const Status status = difficulties.validate(); !status.ok()) return status;
  return validate_timing(depth_schedule, fps);
}

}  // namespace plvo
