// SPDX-License-Identifier: Apache-2.0
// What a gyro and an accelerometer on the camera of the procedural sequence read, 120 times a second, with an
// offset that is there to be learnt.
#pragma once

#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "procedural_sequence.hpp"

namespace plvo {

struct ImuReading {
  std::int64_t stamp_ns = 0;
  Vector3 rate = Vector3::Zero(), force = Vector3::Zero();
};

// After frame i − 1 up to frame i; the first call has those of the first frame's moment.
inline std::vector<ImuReading> imu_readings(int i) {
  const Se3 T_world_now = ProceduralSequence::T_world_camera(i);
  const Matrix3 R_before_now =
      ProceduralSequence::T_world_camera(i == 0 ? -1 : i - 1).R.transpose() * T_world_now.R;
  const Vector3 rate = 30 * rotation_log(R_before_now) + Vector3(0.02, -0.01, 0.015);
  const Vector3 force = T_world_now.R.transpose() * Vector3(0, -9.8, 0) + Vector3(0.1, 0, -0.1);
  std::vector<ImuReading> readings;
  for (int k = 1; k <= 4; ++k)
    readings.push_back({ProceduralSequence::stamp_ns(i) - (4 - k) * 8'333'333, rate, force});
  return readings;
}

}  // namespace plvo
