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
  std::size_t motions = 0;
  // RMS errors of these motions against the truth (m, rad).
  double first_m = 0, first_rad = 0;
  double second_m = 0, second_rad = 0;
  // Of a single true pose, in each axis; 0 where the errors have nothing in common.
  TruthSigma sigma;
};

// Sums up the errors of two estimates of the same motions against the truth.
class CommonErrors {
 public:
  void add(const Vector6& first, const Vector6& second);
  TruthNoise noise() const;

 private:
  std::size_t motions_ = 0;
  // Of translation and of rotation.
  Vector2 first_squares_ = Vector2::Zero(), second_squares_ = Vector2::Zero(), products_ = Vector2::Zero();
};

// Of the motions from one stamp that both estimates have, and the truth, to the next.
TruthNoise truth_noise(const Trajectory& ground_truth, const Trajectory& first, const Trajectory& second,
                       const TruthSampling& sampling);

}  // namespace plvo::eval
