// SPDX-License-Identifier: Apache-2.0
// What a calibration found, for people and for machines.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/calibrate/timing_search.hpp"

namespace plvo::calibrate {

// The names and meanings of the three, in the order of TimingResult::sigma_s.
struct TimingName {
  const char* key;   // as in a calibration file
  const char* what;  // for people
};
extern const std::array<TimingName, 3> kTimingNames;
double value_of(const SensorTiming& timing, std::size_t index);

// An SD above these (s) says that the recordings do not tell.
inline constexpr std::array<double, 3> kMostSigma_s = {0.003, 0.008, 0.008};
bool is_told(const TimingResult& result, std::size_t index);

std::string to_text(const TimingResult& result);
nlohmann::ordered_json to_json(const TimingResult& result);
// One page with the curves, which loads nothing from anywhere.
std::string to_html(const TimingResult& result, const std::vector<std::string>& recordings);

}  // namespace plvo::calibrate
