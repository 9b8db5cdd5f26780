// SPDX-License-Identifier: Apache-2.0
// Tests whether the reported covariance C is correct. If so, the normalised estimation error squared, NEES =
// eᵀ C⁻¹ e of the ⊞-error e, is a chi-square variable with 6 degrees of freedom, or 3 for translation or
// rotation alone. Its mean is then 6 (3); a larger mean is overconfident, a smaller one is conservative. The
// median tells the same and is robust to outliers.
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

// NEES of one kind of error: all six degrees of freedom, or three of them.
struct Nees {
  int dof = 6;
  double mean = 0, median = 0;
  double inside_95 = 0;  // fraction of samples below the chi-square 95 % bound
  // Intervals that contain mean and median in 95 of 100 recordings if the covariance is correct.
  Band mean_band{}, median_band{};
};

// Noise of the ground truth: standard deviations in each axis; the errors of different poses are independent.
struct TruthSigma {
  double position_m = 0;
  double orientation_rad = 0;

  // Returns the covariance that this noise adds to the motion T_b_a = T_w_b⁻¹ T_w_a between two true poses;
  // t: its translation.
  Matrix6 of_motion(const Vector3& t) const;
};

struct Consistency {
  std::size_t count = 0;        // samples with a usable covariance and truth
  std::size_t independent = 0;  // number of them that do not overlap in time; the bands assume this number
  std::size_t singular = 0;     // omitted: the covariance was not positive definite
  std::size_t broken = 0;       // omitted: frames were lost between the two ends
  Nees all{6}, translation{3}, rotation{3};
};

// Error e of a pose; the truth is aligned with the estimate at the first pose.
struct PoseError {
  std::int64_t stamp_ns = 0;
  Vector6 error = Vector6::Zero();  // position (m), orientation (rad)
  std::optional<Vector6> sigma;     // reported standard deviations
};
std::vector<PoseError> pose_errors(const PairedPoses& poses,
                                   const std::vector<StampedCovariance>& covariances);

// Tests the poses. The errors of neighbouring poses are almost equal, so the bands are far too narrow for
// them.
Consistency pose_consistency(const PairedPoses& poses, const std::vector<StampedCovariance>& covariances,
                             const TruthSigma& truth_sigma);
// Tests the single motions, frame to reference: the sharper test if the truth is accurate enough.
Consistency motion_consistency(const std::vector<UncertainMotion>& motions, const Trajectory& ground_truth,
                               const TruthSampling& sampling, const TruthSigma& truth_sigma);
// Tests the motions over span_ns, chained from the single ones. Over a second the jitter of motion capture
// has little weight, and the correlation of neighbouring errors accumulates. Each frame starts one sample.
Consistency span_consistency(const std::vector<UncertainMotion>& motions, std::int64_t span_ns,
                             const Trajectory& ground_truth, const TruthSampling& sampling,
                             const TruthSigma& truth_sigma);

}  // namespace plvo::eval
