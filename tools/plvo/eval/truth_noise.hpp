// SPDX-License-Identifier: Apache-2.0
// How far the ground truth itself is off. Two estimates that err independently of each other, say of points
// alone and of lines alone, have in their errors against the truth only the truth's own in common: the mean
// of the product of the two errors is its variance. What the estimates do have in common (the calibration)
// counts as the truth's.
#pragma once

#include "plvo/eval/consistency.hpp"
#include "plvo/eval/trajectory.hpp"

namespace plvo::eval {

struct TruthNoise {
  std::size_t motions = 0;  // from one common stamp to the next
  // RMS errors of these motions against the truth (m, rad).
  double first_m = 0, first_rad = 0;
  double second_m = 0, second_rad = 0;
  // Of a single true pose, in each axis; 0 where the errors have nothing in common.
  TruthSigma sigma;
};

// Of the motions between poses that both estimates have, and the truth.
TruthNoise truth_noise(const Trajectory& ground_truth, const Trajectory& first, const Trajectory& second,
                       const TruthSampling& sampling);

}  // namespace plvo::eval
