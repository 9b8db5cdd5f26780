// SPDX-License-Identifier: Apache-2.0
// Hands the samples of a recording to the integrator of core/plvo/inertial, frame by frame. It gets only the
// samples that a live sensor would have sent until the frame.
#pragma once

#include <cstddef>
#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/replay/imu_files.hpp"

namespace plvo {

class RecordedImu {
 public:
  Status init(ImuRecording recording, const ImuConfig& config);
  // The integrator with the samples that are there when a frame of this stamp is tracked. Frames come in
  // their order.
  ImuIntegrator& until(std::int64_t stamp_ns);

 private:
  ImuRecording recording_;
  std::size_t next_gyro_ = 0, next_acceleration_ = 0;
  std::vector<ImuSample> gyro_memory_, accelerometer_memory_;
  ImuIntegrator integrator_;
};

}  // namespace plvo
