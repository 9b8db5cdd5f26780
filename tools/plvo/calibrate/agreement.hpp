// SPDX-License-Identifier: Apache-2.0
// Criterion of the calibration: how well the frames of a recording agree under a candidate timing of the
// sensor. For each pair of frames the points and lines are lifted to 3D with that timing, and the motion is
// estimated as in the odometry. The criterion sums the squared Mahalanobis distances of the remaining
// residuals, truncated, so that every outlier has the same cost. Lower is better.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "plvo/calibrate/tracked_recording.hpp"

namespace plvo::calibrate {

// The unknowns of the calibration, in seconds, as in CameraModel.
struct SensorTiming {
  double depth_delay_s = 0, depth_readout_s = 0, readout_s = 0;
};
SensorTiming timing_of(const CameraModel& camera);
CameraModel with_timing(const CameraModel& camera, const SensorTiming& timing);

// Returns the cost of every step-th pair, starting with the first, recording after recording. threads ≥ 1;
// the costs do not depend on it.
std::vector<double> disagreement(std::span<const TrackedRecording> recordings, const SensorTiming& timing,
                                 std::size_t step, int threads);

}  // namespace plvo::calibrate
