// SPDX-License-Identifier: Apache-2.0
// What the accuracy gate compares with: for each row (a sequence and a kind of features) the mean over
// several starts of each figure, and the standard deviation of one start. The starts differ in the first
// frame, by a twentieth of a pixel in the principal point, and in RANSAC's seed; what they differ by is
// chance.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo::accuracy {

// One start of one row. A figure that does not exist (fewer than two seconds tracked) is NaN.
struct Figures {
  double translation_mm_per_s = 0;  // RMSE of the relative pose error over one second
  double rotation_deg_per_s = 0;    // RMSE
  double nees = 0;                  // mean over the motions of one second; 6 if the covariance is true
  int lost = 0;                     // frames
};

struct Estimate {
  double mean = 0, deviation = 0;  // NaN where a start has no such figure
  // The same without the start that is farthest from the median. One start that went wrong makes the
  // deviation so large that chance would explain anything; these two still tell whether the others became
  // worse.
  double mean_of_most = 0, deviation_of_most = 0;
};

struct Row {
  std::string name;
  int starts = 0;
  Estimate translation_mm_per_s, rotation_deg_per_s;
  Estimate log_nees;  // of ln(NEES / 6): 0 if the covariance is true
  int lost = 0;       // frames, over all starts
};

// At least one start.
Row summarise(const std::string& name, const std::vector<Figures>& starts);

// CSV with a header line. kNotFound, kDamaged with file and line.
Status read_baseline(const std::filesystem::path& path, std::vector<Row>& rows);
std::string baseline_text(const std::vector<Row>& rows);

// How `now` is worse than `before` by more than chance, a sentence for each figure; empty if it is not.
// Chance is three standard deviations of the difference of two means, 3 s √(2/n), with the baseline's s; for
// the mean of most starts four, because its deviation is smaller than that of all by what was left out. Where
// the starts hardly differ it is 2 % of an error and 0.05 of ln(NEES / 6), which no user notices. An error
// may grow by it; ln(NEES / 6) may move away from 0 by it; L lost frames may become L + 3 √L. A figure that
// existed must go on to exist.
std::vector<std::string> worse_by_more_than_chance(const Row& before, const Row& now);

}  // namespace plvo::accuracy
