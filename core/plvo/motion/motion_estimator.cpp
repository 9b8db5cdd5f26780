// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_estimator.hpp"

#include "plvo/math/cholesky.hpp"
#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {
namespace {

// The consensus is solved over twice, first with wider χ² thresholds: a match far more precise than the
// motion so far would otherwise fail the test for the motion's error, and never get to correct it. Wider by
// the first factor around a motion that RANSAC found and refined, by the second around one that the caller
// estimated.
constexpr double kWiderThanRefined = 4;
constexpr double kWiderThanEstimated = 9;
// Where the wide round led more SDs away than this it is made again, from there: what matches were judged by
// is not where the motion is, and a consensus at the thresholds would leave out good ones for good.
constexpr double kFarSigmas = 10;
constexpr int kMaxWideRounds = 4;
// Below this ratio of the eigenvalues of the information (scaled to a unit diagonal) an inverse is rounding
// error.
constexpr double kMinEigenvalueRatio = 1e-10;

double largest_eigenvalue(const Matrix3& C) { return symmetric_eigen<3>(C).values.maxCoeff(); }

// C = H⁻¹, or false when H does not determine all six degrees of freedom, by the two rules stated in the
// header.
bool invert_information(const Matrix6& H, const MotionConfig& config, Matrix6& C) {
  if (!H.allFinite() || !(H.diagonal().minCoeff() > 0)) return false;
  // To a unit diagonal first: metres and radians then weigh alike, and the eigenvalues mean something.
  Vector6 scale;
  for (int i = 0; i < 6; ++i) scale[i] = 1 / sqrt(H(i, i));
  Matrix6 unit;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) unit(i, j) = H(i, j) * scale[i] * scale[j];
  const Vector6 values = symmetric_eigen<6>(unit).values;
  if (!(values.minCoeff() > kMinEigenvalueRatio * values.maxCoeff())) return false;
  Cholesky<6> cholesky;
  if (!cholesky.factor(unit)) return false;
  C = cholesky.inverse();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) C(i, j) *= scale[i] * scale[j];
  const Matrix3 C_translation = C.block<3, 3>(0, 0);
  const Matrix3 C_rotation = C.block<3, 3>(3, 3);
  return C.allFinite() && largest_eigenvalue(C_translation) <= config.max_sigma_m * config.max_sigma_m &&
         largest_eigenvalue(C_rotation) <= config.max_sigma_rad * config.max_sigma_rad;
}

// These two are apart, for an estimate on the stack would else be there while the next one is made.
[[gnu::noinline]] void reset(MotionEstimate& estimate) {
  // In place: 3 kB less of stack than another one to copy from.
  ::new (static_cast<void*>(&estimate)) MotionEstimate;
}

// What a failure leaves of an estimate: how it came to it.
void forget_motion(MotionEstimate& estimate) {
  const StatusCode status = estimate.status;
  const RansacSummary ransac = estimate.ransac;
  const LmSummary lm = estimate.lm;
  reset(estimate);
  estimate.status = status;
  estimate.ransac = ransac;
  estimate.lm = lm;
  if (estimate.lm.status == LmStatus::kNotFinite) estimate.lm.initial_cost = estimate.lm.final_cost = 0;
}

void count(std::span<ConstraintSet* const> sets, MotionEstimate& estimate) {
  for (std::size_t kind = 0; kind < sets.size(); ++kind) {
    const ConstraintSet& set = *sets[kind];
    for (std::size_t i = 0; i < set.size(); ++i) {
      estimate.inliers[kind] += set.inliers()[i];
      estimate.usable[kind] += set.usable(i) ? 1 : 0;
    }
  }
}

StatusCode solve(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                 const MotionConfig& config, const LmOptions& lm, std::uint64_t seed,
                 const MotionStart& start, std::span<RansacCandidate> scratch, MotionSolver& solving,
                 MotionEstimate& estimate) {
  const MotionProblem::Kernels kernels =
      MotionProblem::make_kernels(sets, config.robust ? RobustLoss::kHuber : RobustLoss::kNone);
  solving.references = references;
  Ransac ransac(sets, solving.references, config, kernels, scratch, solving);
  if (ransac.samplable() < 3 || static_cast<int>(ransac.usable()) < config.min_inliers)
    return StatusCode::kTooFewFeatures;
  const double least_share = config.min_inlier_ratio * static_cast<double>(ransac.usable());
  const auto consensus = [&] {
    return ransac.inliers() >= config.min_inliers && ransac.inliers() >= least_share;
  };

  Se3 T;
  MotionProblem& problem = solving.problem;
  LevenbergMarquardt<6>& solver = solving.solver;
  NuisanceParameters shared = start.shared;
  // From T, over the inliers that are flagged.
  const auto refine = [&](const LmOptions& options) {
    if (!consensus()) return StatusCode::kNoConsensus;
    problem.start(sets, solving.references, shared, kernels, T);
    estimate.lm = solving.solve(options);
    if (estimate.lm.status == LmStatus::kNotFinite || estimate.lm.status == LmStatus::kSingular)
      return StatusCode::kDegenerate;
    T = problem.T_current_reference();
    solving.references = problem.poses();
    Cholesky<6> cholesky;
    if (cholesky.factor(solver.hessian())) estimate.shared = problem.shared(cholesky.inverse());
    shared.value = estimate.shared.value;
    return StatusCode::kOk;
  };
  // Leaves the inliers at the thresholds flagged.
  const auto approach = [&](double scale) {
    for (int round = 0; round < kMaxWideRounds; ++round) {
      ransac.judge(T, scale);
      const StatusCode status = refine(LmOptions::one_step());
      if (status != StatusCode::kOk) return status;
      if (solver.next_decrease() <= 0.5 * kFarSigmas * kFarSigmas) break;
      scale = kWiderThanRefined;
    }
    ransac.judge(T, 1);
    return StatusCode::kOk;
  };
  StatusCode status = StatusCode::kOk;
  if (start.estimated) {
    T = *start.prediction;
    status = approach(kWiderThanEstimated);
    if (status != StatusCode::kOk && status != StatusCode::kNoConsensus) return status;
  }
  if (!start.estimated || !consensus()) {
    // What an estimate that nothing agrees with made of them is forgotten.
    solving.references = references;
    shared = start.shared;
    if (!ransac.run(seed, start.prediction, T, estimate.ransac)) return StatusCode::kNoConsensus;
    status = approach(kWiderThanRefined);
    if (status != StatusCode::kOk) return status;
  }
  status = refine(lm);
  if (status != StatusCode::kOk) return status;
  for (std::size_t kind = 0; kind < sets.size() && kind < kInformedKinds; ++kind)
    estimate.information[kind] = problem.information(kind);
  estimate.references = problem.references();
  // What is not determined does not converge either: say the cause, not the symptom.
  if (!T.is_finite() || !ransac.consensus_fixes_motion(seed) ||
      !invert_information(solver.hessian(), config, estimate.C_H))
    return StatusCode::kDegenerate;
  // kStalled is as good as converged: no step in any direction lowers the cost any more.
  if (!converged(estimate.lm.status) && estimate.lm.status != LmStatus::kStalled)
    return StatusCode::kNotConverged;
  estimate.T_current_reference = T;
  estimate.motions = motions_to_current(T, solving.references);
  return StatusCode::kOk;
}

}  // namespace

LmSummary MotionSolver::solve(const LmOptions& options) {
  const LmSummary summary = solver.solve(problem, options);
  if (converged(summary.status) || summary.status == LmStatus::kMaxIterations)
    problem.advance(solver.next_step());
  return summary;
}

void estimate_motion(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                     const MotionConfig& config, const LmOptions& lm, std::uint64_t seed,
                     const MotionStart& start, Arena& arena, MotionEstimate& estimate) {
  if (sets.size() > kMaxConstraintKinds) sets = sets.first(kMaxConstraintKinds);
  std::size_t matches = 0;
  for (ConstraintSet* set : sets) {
    matches += set->size();
    for (std::uint8_t& flag : set->inliers()) flag = 0;
  }
  const ScratchScope scope(arena);
  const std::span<RansacCandidate> scratch = take_ransac_scratch(arena, matches);
  const std::span<MotionSolver> solver = take_solver(arena);
  reset(estimate);
  estimate.status = scratch.size() < matches || solver.empty()
                        ? StatusCode::kOutOfMemory
                        : solve(sets, references, config, lm, seed, start, scratch, solver[0], estimate);
  if (estimate.status != StatusCode::kOk) {
    for (ConstraintSet* set : sets)
      for (std::uint8_t& flag : set->inliers()) flag = 0;
    forget_motion(estimate);
  }
  count(sets, estimate);
}

}  // namespace plvo
