// SPDX-License-Identifier: Apache-2.0
// Everything that `plvo eval` reports about one estimate, and its output formats.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/eval/alignment.hpp"
#include "plvo/eval/consistency.hpp"
#include "plvo/eval/relative_error.hpp"
#include "plvo/eval/trajectory.hpp"
#include "plvo/eval/truth_fit.hpp"

namespace plvo::eval {

struct EvaluationOptions {
  TruthSampling sampling;
  TruthSigma truth_sigma;        // added to the covariance in the NEES
  bool fit_truth = false;        // correct the truth by fit_truth(); requires interpolation
  std::int64_t offset_ns = 0;    // added to the stamps of the estimate
  std::vector<RpeDelta> deltas;  // empty: one frame and one second
};

struct Interval {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
};

struct Evaluation {
  GroundTruthSampling sampling = GroundTruthSampling::kInterpolated;
  TruthSigma truth_sigma;
  std::optional<TruthFit> truth_fit;  // if set, the results below use the corrected truth
  RpeErrors second_before_fit;        // uses the truth as measured
  std::size_t estimate_poses = 0;
  PairedPoses poses;  // those with ground truth
  double duration_s = 0;
  double path_m = 0;  // of the truth

  std::vector<RpeResult> rpe;
  AbsoluteError ate;
  Statistics ate_identity;
  EndDrift drift, drift_identity;
  std::vector<DistanceError> by_distance;

  // Intervals of lost frames: consecutive poses of the estimate that are more than 2.5 of its median steps
  // apart.
  std::vector<Interval> lost;
  // Intervals of poses without ground truth.
  std::vector<Interval> without_truth;

  std::vector<PoseError> errors;
  std::optional<Consistency> pose_nees;
  std::optional<Consistency> motion_nees;
  std::optional<Consistency> second_nees;  // of the motions over a second
};

// Returns kInvalidArgument if fewer than two poses of the estimate have a true pose, if both files are
// KITTI's without stamps and differ in their number of rows, and the errors of fit_truth().
Status evaluate(const Trajectory& measured_truth, const Trajectory& estimate,
                const std::vector<StampedCovariance>& covariances,
                const std::vector<UncertainMotion>& motions, const EvaluationOptions& options,
                Evaluation& result);

// Returns a warning if the best-fit scale differs from 1 by more than 5 %, removes at least half of the
// absolute error, and differs by more than three times the ratio of the error that is left to that of the
// zero-motion baseline. Otherwise empty: some scale fits any bad estimate slightly better.
std::string doubt_about_scale(const Evaluation& evaluation);
// Returns that sentence and one for a NEES far from its expectation, with the most frequent reason and what
// to try.
std::vector<std::string> doubts_about(const Evaluation& evaluation);

std::string to_text(const Evaluation& evaluation);
nlohmann::ordered_json to_json(const Evaluation& evaluation);

}  // namespace plvo::eval
