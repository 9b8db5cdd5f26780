// SPDX-License-Identifier: Apache-2.0
// Result of a calibration, as text, JSON and HTML.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/calibrate/timing_search.hpp"

namespace plvo::calibrate {

// Names and meanings of the three unknowns, in the order of TimingResult::sigma_s.
struct TimingName {
  const char* key;   // key in a calibration file
  const char* what;  // for people
};
extern const std::array<TimingName, 3> kTimingNames;
double value_of(const SensorTiming& timing, std::size_t index);

// Standard deviations (s) above which the recordings do not determine the unknown.
inline constexpr std::array<double, 3> kMostSigma_s = {0.003, 0.008, 0.008};
bool is_determined(const TimingResult& result, std::size_t index);

std::string to_text(const TimingResult& result);
nlohmann::ordered_json to_json(const TimingResult& result);
// Returns a self-contained page with the curves.
std::string to_html(const TimingResult& result, const std::vector<std::string>& recordings);

}  // namespace plvo::calibrate
