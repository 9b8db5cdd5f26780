// SPDX-License-Identifier: Apache-2.0
// What a run has to say at its end, for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "plvo/cli/common/track_summary.hpp"
#include "plvo/cli/map/map_summary.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::cli {

class RunSummary : public TrackSummary {
 public:
  SummaryRows rows() const;
  std::string to_text() const;
  nlohmann::ordered_json to_json() const;

  // Set by the run.
  struct Image {
    int width = 0, height = 0;
    int scaled_down_by = 1;
  } image;  // as it is tracked
  std::size_t unpaired_images = 0;
  std::optional<MapSummary> map;
  Status failure;                              // ended the run before its last frame
  std::optional<eval::Evaluation> evaluation;  // where there is ground truth
};

}  // namespace plvo::cli
