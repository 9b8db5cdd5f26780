// SPDX-License-Identifier: Apache-2.0
// Is the reported covariance true? The normalised estimation error squared, NEES = eᵀ C⁻¹ e, of the ⊞-error e
// is a chi-square variable when it is, of 6 degrees of freedom, or of 3 for translation or rotation alone:
// its mean is 6 (3), more means overconfident, less means timid. The median says the same without the
// outliers.
#pragma once

#include <optional>
#include <vector>

#include "plvo/eval/relative_error.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/eval/uncertainty_file.hpp"

namespace plvo::eval {

struct Band {
  double low = 0, high = 0;
};

// Of one kind of error: all six degrees of freedom, or three of them.
struct Nees {
  int dof = 6;
  double mean = 0, median = 0;
  double inside_95 = 0;  // share of samples below the chi-square 95 % bound
  // Where mean and median lie in 95 of 100 recordings if the covariance is true.
  Band mean_band{}, median_band{};
};

// How far a true pose is off: standard deviations in each axis, of poses that err independently.
struct TruthSigma {
  double position_m = 0;
  double orientation_rad = 0;

  // What it adds to the covariance of the motion T_b_a = T_w_b⁻¹ T_w_a between two true poses; t: its
  // translation.
  Matrix6 of_motion(const Vector3& t) const;
};

struct Consistency {
  std::size_t count = 0;        // samples with a usable covariance and truth
  std::size_t independent = 0;  // how many of them share no stretch of the recording: the bands are for these
  std::size_t singular = 0;     // left out: the covariance was not positive definite
  std::size_t broken = 0;       // left out: frames were lost between the two ends
  Nees all{6}, translation{3}, rotation{3};
};

// e of a pose, with the truth moved so that it starts where the estimate does.
struct PoseError {
  std::int64_t stamp_ns = 0;
  Vector6 error = Vector6::Zero();  // position (m), orientation (rad)
  std::optional<Vector6> sigma;     // standard deviations reported for it
};
std::vector<PoseError> pose_errors(const PairedPoses& poses,
                                   const std::vector<StampedCovariance>& covariances);

// Of the poses. Errors of neighbours are nearly the same error: the bands are far too narrow for them.
Consistency pose_consistency(const PairedPoses& poses, const std::vector<StampedCovariance>& covariances,
                             const TruthSigma& truth_sigma);
// Of the single motions, frame to reference: the sharper test, where the truth is sharp enough.
Consistency motion_consistency(const std::vector<UncertainMotion>& motions, const Trajectory& ground_truth,
                               const TruthSampling& sampling, const TruthSigma& truth_sigma);
// Of the motions over span_ns, chained from the single ones: over a second the jitter of motion capture
// counts little, and what neighbouring errors have in common adds up. One sample from each frame on.
Consistency span_consistency(const std::vector<UncertainMotion>& motions, std::int64_t span_ns,
                             const Trajectory& ground_truth, const TruthSampling& sampling,
                             const TruthSigma& truth_sigma);

}  // namespace plvo::eval
