// SPDX-License-Identifier: Apache-2.0
// Finds the sensor timing at which the recordings agree best (agreement.hpp). The set of matches depends
// slightly on the timing with which the odometry found them. Therefore the recordings are tracked again with
// each result until it settles.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/calibrate/agreement.hpp"
#include "plvo/math/types.hpp"

namespace plvo::calibrate {

inline constexpr double kDegrees = 57.29577951308232;  // degrees per radian

struct CurvePoint {
  double seconds = 0;
  double disagreement = 0;  // mean over all matches: 3 to 4 for a correct model, 30 if no match fits
};

struct TimingResult {
  SensorTiming timing;
  // A global shutter: no readout of colour above 0 agrees better.
  bool global_shutter = false;
  // Standard deviations of depth_delay_s, depth_readout_s and readout_s. 0: the unknown was not estimated or
  // does not exist (global shutter); infinite: the recordings do not determine it.
  std::array<double, 3> sigma_s{};
  std::array<std::vector<CurvePoint>, 3> curves;  // each along one unknown, with the others as found
  std::vector<SensorTiming> passes;               // result of each pass over the recordings
  bool settled = false;                           // the last pass changed little
  std::size_t frames = 0, pairs = 0;
  double turn_rad_per_s = 0;  // RMS of the angular rate
  double stamp_sigma_s = -1;  // stamp_jitter_s()
};

struct TimingSearch {
  // Tracks the recordings anew with this timing.
  std::function<Status(const SensorTiming&, std::vector<TrackedRecording>&)> track;
  // Called often, with a description of the current step.
  std::function<void(const std::string&)> on_progress = [](const std::string&) {};
  // Called twice in each pass: with the number of tracked frames, and with the result.
  std::function<void(const std::string&)> on_result = [](const std::string&) {};
  SensorTiming start;
  bool find_readouts = true;  // false: keep those of the start
  int threads = 1;
};

// Returns kTooFewFeatures if too few frames were tracked, and kDegenerate if the camera hardly rotates. Both
// messages say what to record instead.
Status find_timing(const TimingSearch& search, TimingResult& result);

}  // namespace plvo::calibrate
