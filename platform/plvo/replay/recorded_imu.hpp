// SPDX-License-Identifier: Apache-2.0
// The samples of a recording as the priors of its frames: what a live sensor would have sent until the frame
// was there is handed to the integrator of core/plvo/inertial, no more.
#pragma once

#include <cstddef>
#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/replay/imu_files.hpp"

namespace plvo {

class RecordedImu {
 public:
  Status init(ImuRecording recording, const ImuConfig& config);
  // As of ImuIntegrator.
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
