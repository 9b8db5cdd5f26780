// SPDX-License-Identifier: Apache-2.0
// The tables of the lighting experiment.
#pragma once

#include <string>
#include <vector>

#include "plvo/bench/jobs/campaign.hpp"

namespace plvo::bench {

struct Walk {
  std::string site, light;
  int seed = 1;
  int frames = 0;
  std::string sequence;  // the name that its results bear
};

// A row for each site and light: the median over the seeds of every system's end-point drift, the mean over
// the sites for each light, and how much the lamp makes it worse. A second table with the relative error per
// second, in which standing still is seen for what it is (a closed walk ends where it began: no drift).
Report lighting_report(const std::vector<Walk>& walks, const std::vector<std::string>& systems,
                       const std::vector<Result>& results);

}  // namespace plvo::bench
