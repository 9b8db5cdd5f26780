// SPDX-License-Identifier: Apache-2.0
// Estimates the noise of the ground truth. If two estimates have independent errors, for example one from
// points and one from lines, their errors against the truth have only the truth's error in common: the mean
// of the product of the two errors is its variance. A common error of the estimates (the calibration) counts
// as the truth's.
#pragma once

#include "plvo/eval/consistency.hpp"
#include "plvo/eval/trajectory.hpp"

namespace plvo::eval {

struct TruthNoise {
  std::size_t motions = 0;
  // RMS errors of these motions against the truth (m, rad).
  double first_m = 0, first_rad = 0;
  double second_m = 0, second_rad = 0;
  // Noise of a single true pose, in each axis; 0 if the errors are not positively correlated.
  TruthSigma sigma;
};

// Accumulates the errors of two estimates of the same motions against the truth.
class CommonErrors {
 public:
  void add(const Vector6& first, const Vector6& second);
  TruthNoise noise() const;

 private:
  std::size_t motions_ = 0;
  // Components: translation, rotation.
  Vector2 first_squares_ = Vector2::Zero(), second_squares_ = Vector2::Zero(), products_ = Vector2::Zero();
};

// Uses the motions between consecutive stamps that both estimates and the truth have.
TruthNoise truth_noise(const Trajectory& ground_truth, const Trajectory& first, const Trajectory& second,
                       const TruthSampling& sampling);

}  // namespace plvo::eval
