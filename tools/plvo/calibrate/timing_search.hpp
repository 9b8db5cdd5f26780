// SPDX-License-Identifier: Apache-2.0
// Finds the timing of a sensor at which its recordings agree best (agreement.hpp). Which matches there are
// depends a little on the timing that the odometry found them with, so the recordings are tracked again with
// what was found, until it stays.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/calibrate/agreement.hpp"
#include "plvo/math/types.hpp"

namespace plvo::calibrate {

inline constexpr double kDegrees = 57.29577951308232;  // of a radian

struct CurvePoint {
  double seconds = 0;
  double disagreement = 0;  // mean of all matches: 3 to 4 where the model is right, 30 where nothing fits
};

struct TimingResult {
  SensorTiming timing;
  // No readout of colour above 0 agrees better: all its rows are exposed at once.
  bool global_shutter = false;
  // SD of depth_delay_s, depth_readout_s and readout_s, in this order; 0 where it was not looked for
  // or has none (a global shutter), infinite where the recordings do not tell.
  std::array<double, 3> sigma_s{};
  std::array<std::vector<CurvePoint>, 3> curves;  // each along one of them, the others as found
  std::vector<SensorTiming> passes;               // what each pass over the recordings ended with
  bool settled = false;                           // the last pass changed little
  std::size_t frames = 0, pairs = 0;
  double turn_rad_per_s = 0;  // RMS
  double stamp_sigma_s = -1;  // stamp_jitter_s()
};

struct TimingSearch {
  // Tracks the recordings anew with this timing.
  std::function<Status(const SensorTiming&, std::vector<TrackedRecording>&)> track;
  // Called often, with what is being done.
  std::function<void(const std::string&)> on_progress = [](const std::string&) {};
  // Called twice in each pass: with what was tracked, and with what was found.
  std::function<void(const std::string&)> on_result = [](const std::string&) {};
  SensorTiming start;
  bool find_readouts = true;  // false: the start's are kept
  int threads = 1;
};

// kTooFewFeatures where too little was tracked, kDegenerate where the camera hardly turns: both say what to
// record instead.
Status find_timing(const TimingSearch& search, TimingResult& result);

}  // namespace plvo::calibrate
