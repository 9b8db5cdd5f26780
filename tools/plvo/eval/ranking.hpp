// SPDX-License-Identifier: Apache-2.0
// Several estimates of one sequence, best first.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/eval/evaluation.hpp"

namespace plvo::eval {

struct NamedEvaluation {
  std::string name;
  Evaluation evaluation;
  std::vector<std::string> warnings;
};

// Sorts by the RMSE of the relative translation over the last of the deltas, which by default is a second.
// Estimates without a pair that far apart follow, sorted by their ATE.
void rank(std::vector<NamedEvaluation>& estimates);

// Returns the seconds between the first and the last pose with ground truth, without those of lost frames.
double covered_s(const Evaluation& evaluation);

// Returns a sentence for each estimate that covers less than 90 % of the seconds of the one that covers most:
// whoever leaves out the hard part has smaller errors.
std::vector<std::string> doubts_about_ranking(const std::vector<NamedEvaluation>& ranked);

std::string ranking_text(const std::vector<NamedEvaluation>& ranked);
nlohmann::ordered_json ranking_json(const std::vector<NamedEvaluation>& ranked);

}  // namespace plvo::eval
