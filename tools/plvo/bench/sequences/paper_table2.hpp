// SPDX-License-Identifier: Apache-2.0
// Results of Lu & Song's Table 2 (ICCV 2015) for the nine fr1 sequences, for comparison with the
// measurements.
#pragma once

#include <string>
#include <vector>

#include "plvo/bench/jobs/result.hpp"

namespace plvo::bench {

// The nine sequences in the paper's order: "360", "desk", …
const std::vector<std::string>& paper_sequences();

// "rpy" for freiburg1_rpy, rgbd_dataset_freiburg1_rpy, fr1_rpy, and for parts of it such as fr1_rpy_150;
// empty for any other name.
struct PaperSequence {
  std::string name;
  bool whole = false;
};
PaperSequence paper_sequence(const std::string& folder);

// Returns one result for each system of the paper; NaN if the paper has no value. `name`: one of the nine, or
// "mean".
std::vector<Result> paper_results(const std::string& name);

}  // namespace plvo::bench
