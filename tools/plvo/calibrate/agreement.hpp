// SPDX-License-Identifier: Apache-2.0
// How well the frames of a recording agree if the sensor's timing is such: the criterion of the calibration.
// For each pair of frames the points and lines are lifted to 3D with that timing, the motion is estimated as
// the odometry does, and what the matches then leave is summed: squared Mahalanobis distances, truncated, so
// that a match that does not fit counts the same however far off it is. The less, the better.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "plvo/calibrate/tracked_recording.hpp"

namespace plvo::calibrate {

// What is looked for, in seconds: as in CameraModel.
struct SensorTiming {
  double depth_delay_s = 0, depth_readout_s = 0, readout_s = 0;
};
SensorTiming timing_of(const CameraModel& camera);
CameraModel with_timing(const CameraModel& camera, const SensorTiming& timing);

// The disagreement of every step-th pair, starting with the first, recording after recording. threads ≥ 1;
// the sums do not depend on it.
std::vector<double> disagreement(std::span<const TrackedRecording> recordings, const SensorTiming& timing,
                                 std::size_t step, int threads);

}  // namespace plvo::calibrate
