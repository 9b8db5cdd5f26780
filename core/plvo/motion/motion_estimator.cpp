// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_estimator.hpp"

#include "plvo/math/cholesky.hpp"
#include "plvo/math/symmetric_eigen.hpp"

namespace plvo {
namespace {

// The consensus is solved twice, first with wider χ² thresholds. A match far more precise than the current
// motion would otherwise fail the test because of the motion's error, and could never correct it. The first
// factor applies to a motion that RANSAC found and refined, the second one to a motion that the caller
// estimated.
constexpr double kWiderThanRefined = 4;
constexpr double kWiderThanEstimated = 9;
// If the wide round moves the motion by more SDs than this, it is repeated from the new motion. The matches
// were then judged at a wrong motion, and a consensus at the final thresholds would exclude good matches
// permanently.
constexpr double kFarSigmas = 10;
constexpr int kMaxWideRounds = 4;
// The estimate fails with kNoConsensus if a smaller share of the usable matches are inliers.
constexpr double kMinInlierShare = 0.1;
// If a prior contradicts the first motion, another motion is taken that the prior does not contradict and
// that explains at least this share of the evidence. Wrong motions explain less.
constexpr double kShareOfUncontradicted = 0.2;
// Smallest ratio of the eigenvalues of the information matrix (scaled to a unit diagonal). Below it the
// inverse is dominated by rounding errors.
constexpr double kMinEigenvalueRatio = 1e-10;

double largest_eigenvalue(const Matrix3& C) { return symmetric_eigen<3>(C).values.maxCoeff(); }

// C = H⁻¹. Returns false if H does not determine all six degrees of freedom by the two rules stated in the
// header.
bool invert_information(const Matrix6& H, const MotionConfig& config, Matrix6& C) {
  if (!H.allFinite() || !(H.diagonal().minCoeff() > 0)) return false;
  // Scales H to a unit diagonal, so that metres and radians are comparable and the eigenvalues are
  // meaningful.
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

// reset() and forget_motion() are separate functions, because a temporary estimate would otherwise stay on
// the stack during the next estimate.
[[gnu::noinline]] void reset(MotionEstimate& estimate) {
  // Constructs in place, which saves the 3 kB of stack of a temporary.
  ::new (static_cast<void*>(&estimate)) MotionEstimate;
}

// Resets an estimate after a failure; keeps only its diagnostics.
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

void count(std::span<ConstraintSet* const> sets, const CostTerms& terms, MotionEstimate& estimate) {
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (const std::uint8_t flag : terms[i].inliers()) estimate.inliers[i] += flag;
  for (std::size_t s = 0; s < sets.size(); ++s)
    for (std::size_t i = 0; i < sets[s]->size(); ++i) estimate.usable[s] += sets[s]->usable(i) ? 1 : 0;
}

void clear_flags(const CostTerms& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (std::uint8_t& flag : terms[i].inliers()) flag = 0;
}

StatusCode solve(std::span<ConstraintSet* const> sets, const CostTerms& terms,
                 const MotionReferences& references, const MotionConfig& config, const LmOptions& lm,
                 std::uint64_t seed, const MotionStart& start, std::span<RansacCandidate> scratch,
                 MotionSolver& solving, MotionEstimate& estimate) {
  const MotionProblem::Kernels kernels =
      MotionProblem::make_kernels(terms, config.robust ? RobustLoss::kHuber : RobustLoss::kNone);
  solving.references = references;
  Ransac ransac(sets, terms, solving.references, config, kernels, scratch, solving);
  if (ransac.samplable() < 3 || static_cast<int>(ransac.usable()) < config.min_inliers)
    return StatusCode::kTooFewFeatures;
  const double least_share = kMinInlierShare * static_cast<double>(ransac.usable());
  const auto consensus = [&] {
    return ransac.inliers() >= config.min_inliers && ransac.inliers() >= least_share;
  };

  Se3 T;
  MotionProblem& problem = solving.problem;
  LevenbergMarquardt<6>& solver = solving.solver;
  NuisanceParameters shared = start.shared;
  // Refines T over the flagged inliers.
  const auto refine = [&](const LmOptions& options) {
    if (!consensus()) return StatusCode::kNoConsensus;
    problem.start(terms, solving.references, shared, kernels, T);
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
  // On return the inliers at the final thresholds are flagged.
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
  // Approaches the motion anew; what was estimated with another one is discarded.
  const auto approach_from = [&](const Se3& from, double scale) {
    solving.references = references;
    shared = start.shared;
    T = from;
    return approach(scale);
  };
  Se3 first;
  double scale = kWiderThanEstimated;
  StatusCode status = StatusCode::kNoConsensus;
  if (start.estimated) {
    first = *start.prediction;
    status = approach_from(first, scale);
    if (status != StatusCode::kOk && status != StatusCode::kNoConsensus) return status;
  }
  if (status != StatusCode::kOk || !consensus()) {
    scale = kWiderThanRefined;
    if (!ransac.run(seed, start.prediction, first, estimate.ransac)) return StatusCode::kNoConsensus;
    status = approach_from(first, scale);
    if (status != StatusCode::kOk) return status;
  }
  Vector6 apart = Vector6::Zero();
  const double covered = ransac.covered();
  estimate.contradicted = contradict(terms, T, solving.references);
  if (start.search_beside && (covered < kWorldAtRest || estimate.contradicted)) {
    apart = boxminus(T, first);
    Se3 other = T;
    const bool found = ransac.run_beside(seed, start.prediction, other, estimate.ransac) &&
                       approach_from(other, kWiderThanRefined) == StatusCode::kOk && consensus();
    const double covered_by_other = found ? ransac.covered() : 0;
    apart = boxminus(T, first) - apart;
    if (estimate.contradicted || !are_comparable(covered, covered_by_other)) apart.setZero();
    const double least = estimate.contradicted ? kShareOfUncontradicted : covered;
    estimate.is_other = covered_by_other > least && ransac.consensus_fixes_motion(seed);
    if (estimate.is_other) {
      estimate.contradicted = false;
    } else {
      status = approach_from(first, scale);
      if (status != StatusCode::kOk) return status;
    }
  }
  estimate.explained = ransac.covered();
  estimate.evidence = estimate.explained * ransac.evidence();
  status = refine(lm);
  if (status != StatusCode::kOk) return status;
  for (std::size_t i = 0; i < terms.size() && i < kInformedTerms; ++i)
    estimate.information[i] = problem.information(i);
  estimate.references = problem.references();
  // An undetermined motion does not converge either. kDegenerate is tested first because it is the cause.
  if (!T.is_finite() || !ransac.consensus_fixes_motion(seed) ||
      !invert_information(solver.hessian(), config, estimate.C_H))
    return StatusCode::kDegenerate;
  // kStalled counts as converged: no step lowers the cost any further.
  if (!converged(estimate.lm.status) && estimate.lm.status != LmStatus::kStalled)
    return StatusCode::kNotConverged;
  estimate.contain(apart);
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

void estimate_motion(std::span<ConstraintSet* const> sets, std::span<CostTerm* const> others,
                     const MotionReferences& references, const MotionConfig& config, const LmOptions& lm,
                     std::uint64_t seed, const MotionStart& start, Arena& arena, MotionEstimate& estimate) {
  if (sets.size() > kMaxConstraintSets) sets = sets.first(kMaxConstraintSets);
  const CostTerms terms(sets, others);
  clear_flags(terms);
  std::size_t matches = 0;
  for (const ConstraintSet* set : sets) matches += set->size();
  const ScratchScope scope(arena);
  const std::span<RansacCandidate> scratch = take_ransac_scratch(arena, matches);
  const std::span<MotionSolver> solver = take_solver(arena);
  reset(estimate);
  estimate.status =
      scratch.size() < matches || solver.empty()
          ? StatusCode::kOutOfMemory
          : solve(sets, terms, references, config, lm, seed, start, scratch, solver[0], estimate);
  if (estimate.status != StatusCode::kOk) {
    clear_flags(terms);
    forget_motion(estimate);
  }
  count(sets, terms, estimate);
}

}  // namespace plvo
