// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/recorded_imu.hpp"

#include <utility>

namespace plvo {
namespace {

// Ten seconds at 400 Hz between two frames; over a longer time a gyro alone is of little use.
constexpr std::size_t kWaiting = 4096;

}  // namespace

Status RecordedImu::init(ImuRecording recording, const ImuConfig& config) {
  recording_ = std::move(recording);
  next_gyro_ = next_acceleration_ = 0;
  gyro_memory_.assign(kWaiting, {});
  accelerometer_memory_.assign(kWaiting, {});
  return integrator_.init(gyro_memory_, accelerometer_memory_, config);
}

// Adds the samples up to the first one after the frame: the rate is interpolated between it and the one
// before.
ImuIntegrator& RecordedImu::until(std::int64_t stamp_ns) {
  const auto until_after = [&](const std::vector<ImuSample>& samples, std::size_t& next, auto add) {
    while (next < samples.size()) {
      const bool after = samples[next].stamp_ns > stamp_ns;
      if (after && next > 0 && samples[next - 1].stamp_ns > stamp_ns) return;
      add(samples[next++]);
      if (after) return;
    }
  };
  until_after(recording_.gyro, next_gyro_, [&](const ImuSample& s) { (void)integrator_.add_gyro(s); });
  until_after(recording_.accelerometer, next_acceleration_,
              [&](const ImuSample& s) { (void)integrator_.add_acceleration(s); });
  return integrator_;
}

}  // namespace plvo
