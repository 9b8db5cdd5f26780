// SPDX-License-Identifier: Apache-2.0
// What a session with a map has to say of it at its end, for people and as JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "plvo/cli/common/duration_histogram.hpp"
#include "plvo/cli/common/track_summary.hpp"

namespace plvo::cli {

struct MapSummary {
  std::size_t loaded = 0;  // keyframes of --map-in
  bool located = false;    // at the end
  // From the first frame that had a pose to that which was located first.
  std::optional<double> located_after_s;
  std::size_t keyframes = 0, capacity = 0, bytes = 0;
  int removed = 0, compared = 0, accepted = 0, recognised = 0, loops = 0;
  DurationHistogram cpu;        // of Map::update()
  std::optional<double> ate_m;  // where there is ground truth

  SummaryRows rows() const;
  nlohmann::ordered_json to_json() const;
};

}  // namespace plvo::cli
