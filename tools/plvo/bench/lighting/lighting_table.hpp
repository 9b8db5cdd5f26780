// SPDX-License-Identifier: Apache-2.0
// Tables of the lighting experiment.
#pragma once

#include <string>
#include <vector>

#include "plvo/bench/jobs/campaign.hpp"

namespace plvo::bench {

struct LitSequence {
  std::string site, light;
  int seed = 1;
  int frames = 0;
  std::string name;  // of the sequence in its results
};

// The first table has a row for each site and light with the median end-point drift of every system over the
// seeds, the mean over the sites for each light, and the ratio of the two lights. The second table has the
// relative error per second; it exposes the zero-motion baseline, which has no drift on a closed sequence.
Report lighting_report(const std::vector<LitSequence>& sequences, const std::vector<std::string>& systems,
                       const std::vector<Result>& results);

}  // namespace plvo::bench
