// SPDX-License-Identifier: Apache-2.0
// Is the reported covariance true? The normalised estimation error squared, NEES = eᵀ C⁻¹ e, of the ⊞-error e
// averages 6 when it is (3 for position or orientation alone); more means overconfident, less means timid.
#pragma once

#include <optional>
#include <vector>

#include "plvo/eval/relative_error.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/eval/uncertainty_file.hpp"

namespace plvo::eval {

struct Consistency {
  std::size_t count = 0;     // samples with a usable covariance and truth
  std::size_t singular = 0;  // left out: the covariance was not positive definite
  double mean = 0;           // of 6 degrees of freedom
  double mean_position = 0;  // of 3
  double mean_orientation = 0;
  double inside_95 = 0;                // share of samples below the chi-square 95 % bound, 12.592
  double mean_low = 0, mean_high = 0;  // 95 % band of the mean, were the samples independent
};

// e of a pose, with the truth moved so that it starts where the estimate does.
struct PoseError {
  std::int64_t stamp_ns = 0;
  Vector6 error = Vector6::Zero();  // position (m), orientation (rad)
  std::optional<Vector6> sigma;     // standard deviations reported for it
};
std::vector<PoseError> pose_errors(const PairedPoses& poses,
                                   const std::vector<StampedCovariance>& covariances);

// Of the poses: errors of neighbours are nearly the same error, so the band is far too narrow for them.
Consistency pose_consistency(const PairedPoses& poses, const std::vector<StampedCovariance>& covariances);
// Of the single motions, frame to reference: the sharper test, where the truth is sharp enough.
Consistency motion_consistency(const std::vector<UncertainMotion>& motions, const Trajectory& ground_truth,
                               GroundTruthSampling sampling, std::int64_t max_difference_ns);

}  // namespace plvo::eval
