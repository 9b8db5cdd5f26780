// SPDX-License-Identifier: Apache-2.0
// Turns the samples of a recording into the priors of its frames. The integrator of core/plvo/inertial gets
// only the samples that a live sensor would have sent until the frame.
#pragma once

#include <cstddef>
#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/replay/imu_files.hpp"

namespace plvo {

class RecordedImu {
 public:
  Status init(ImuRecording recording, const ImuConfig& config);
  // The same as in ImuIntegrator.
  MotionPrior prior(std::int64_t stamp_ns);
  void learn(const TrackResult& result) { integrator_.learn(result); }
  const ImuIntegrator& integrator() const { return integrator_; }

 private:
  ImuRecording recording_;
  std::size_t next_gyro_ = 0, next_acceleration_ = 0;
  std::vector<ImuSample> gyro_memory_, accelerometer_memory_;
  ImuIntegrator integrator_;
};

}  // namespace plvo
