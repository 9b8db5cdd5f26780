// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_estimator.hpp"

#include "plvo/math/cholesky.hpp"
#include "plvo/math/symmetric_eigen.hpp"
#include "plvo/motion/prior_constraint.hpp"

namespace plvo {
namespace {

// The consensus is found in rounds with wider χ² thresholds, then with the final ones. A match far more
// precise than the current motion would otherwise fail the test because of the motion's error, and could
// never correct it. The second factor applies to the first round from a motion that the caller estimated, the
// first one to all other rounds.
constexpr double kWiderThanRefined = 4;
constexpr double kWiderThanEstimated = 9;
// If the wide round moves the motion by more SDs than this, it is repeated from the new motion. The matches
// were then judged at a wrong motion, and a consensus at the final thresholds would exclude good matches
// permanently.
constexpr double kFarSigmas = 10;
constexpr int kMaxWideRounds = 4;
// New landmarks contradict the proven ones if the motion of all matches has a squared Mahalanobis distance
// above this from that of the proven ones: a χ² test with six degrees of freedom at 0.99.
constexpr double kMostPlausibleOfAll = 16.8;
// The estimate fails with kNoConsensus if a smaller share of the usable matches are inliers.
constexpr double kMinInlierShare = 0.1;
// If a prior contradicts the first motion, another motion is taken that the prior does not contradict and
// that explains at least this share of the evidence. Wrong motions explain less.
constexpr double kShareOfUncontradicted = 0.2;
// Smallest ratio of the eigenvalues of the information matrix (scaled to a unit diagonal). Below it the
// inverse is dominated by rounding errors.
constexpr double kMinEigenvalueRatio = 1e-10;
// Scales of the thresholds in the rounds in which a kind of landmark decides alone. Where it was outvoted,
// its matches contradict the motion by many standard deviations. The first round accepts twenty times the
// distance.
constexpr double kScalesAlone[] = {400, 20, 1};
// A kind of landmark that decides alone is held at the common motion, with kFavoured times its covariance
// plus that of these SDs. In a direction that the kind does not measure, the motion then stays where it is.
// The SDs are for a wrong motion that many features agree on: surfaces would be held there, because its
// covariance is small.
constexpr double kHeld_m = 0.01;
constexpr double kHeld_rad = 0.005;

double largest_eigenvalue(const Matrix3& C) { return symmetric_eigen<3>(C).values.maxCoeff(); }

// C = H⁻¹. Returns false if the ratio of the eigenvalues is too small, or if a standard deviation exceeds its
// bound in MotionConfig: H does not determine all six degrees of freedom then.
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

void count_inliers(const CostTerms& terms, MotionEstimate& estimate) {
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (const std::uint8_t flag : terms[i].inliers()) estimate.inliers[i] += flag;
}

void clear_flags(const CostTerms& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i)
    for (std::uint8_t& flag : terms[i].inliers()) flag = 0;
}

// The motion that the consensus of the matches determines: a first motion with a consensus, another one
// beside it if it explains too little, and the maximum-likelihood estimate over the consensus of the better
// one.
class ConsensusSolver {
 public:
  // start, references, config and solving must outlive this object.
  ConsensusSolver(std::span<ConstraintSet* const> sets, const CostTerms& terms,
                  const MotionReferences& references, const MotionConfig& config, std::uint64_t seed,
                  const MotionStart& start, std::span<RansacCandidate> scratch, MotionSolver& solving,
                  MotionEstimate& estimate)
      : terms_(terms),
        references_(references),
        config_(config),
        seed_(seed),
        start_(start),
        solving_(solving),
        estimate_(estimate),
        kernels_(MotionProblem::make_kernels(terms, loss())),
        ransac_(sets, terms, solving.references, config, kernels_, scratch, solving),
        shared_(start.shared) {}

  StatusCode solve(const LmOptions& lm) {
    if (ransac_.usable() < 3 || static_cast<int>(ransac_.usable()) < config_.min_inliers)
      return StatusCode::kTooFewFeatures;
    StatusCode status = find_first();
    if (status != StatusCode::kOk) return status;
    Vector6 apart = Vector6::Zero();
    look_beside(apart);
    estimate_.explained = ransac_.covered();
    estimate_.evidence = estimate_.explained * ransac_.evidence();
    status = refine(lm);
    if (status != StatusCode::kOk) return status;
    return conclude(apart);
  }

 private:
  bool has_consensus() const {
    return ransac_.inliers() >= config_.min_inliers &&
           ransac_.inliers() >= kMinInlierShare * static_cast<double>(ransac_.leading());
  }

  // Refines T_ over the flagged inliers.
  StatusCode refine(const LmOptions& options) {
    if (!has_consensus()) return StatusCode::kNoConsensus;
    MotionProblem& problem = solving_.problem;
    problem.start(terms_, solving_.references, shared_, kernels_, T_);
    estimate_.lm = solving_.solve(options);
    if (estimate_.lm.status == LmStatus::kNotFinite || estimate_.lm.status == LmStatus::kSingular)
      return StatusCode::kDegenerate;
    T_ = problem.T_current_reference();
    solving_.references = problem.poses();
    Cholesky<6> cholesky;
    if (cholesky.factor(solving_.solver.hessian())) estimate_.shared = problem.shared(cholesky.inverse());
    shared_.value = estimate_.shared.value;
    return StatusCode::kOk;
  }

  void judge(double scale) {
    ransac_.judge(T_, scale);
    if (start_.registered) ransac_.leave_isolated_out();
  }

  // Moves T_ to the motion of its consensus. On return the inliers at the final thresholds are flagged.
  StatusCode approach(double scale) {
    for (int round = 0; round < kMaxWideRounds; ++round) {
      judge(scale);
      const StatusCode status = refine(LmOptions::one_step());
      if (status != StatusCode::kOk) return status;
      if (solving_.solver.next_decrease() <= 0.5 * kFarSigmas * kFarSigmas) break;
      scale = kWiderThanRefined;
    }
    judge(1);
    return StatusCode::kOk;
  }

  // Discards what was estimated with another motion.
  StatusCode approach_from(const Se3& from, double scale) {
    solving_.references = references_;
    shared_ = start_.shared;
    T_ = from;
    return approach(scale);
  }

  // An object that comes into view brings new landmarks, and it may bring more of them than the room has. So
  // the first motion is estimated from proven landmarks alone, if there are enough and most of them agree,
  // and then from all. If the second contradicts the first, the first is taken.
  StatusCode find_first() {
    if (ransac_.let_proven_lead() && find_leading() == StatusCode::kOk && has_consensus() &&
        ransac_.most_leading_agree()) {
      const Se3 proven = T_;
      const Matrix6 information = solving_.solver.hessian();
      ransac_.let_all_lead();
      if (find_leading() == StatusCode::kOk) {
        const Vector6 apart = boxminus(T_, proven);
        if (apart.dot(information * apart) <= kMostPlausibleOfAll) return StatusCode::kOk;
      }
      (void)ransac_.let_proven_lead();
      if (approach_from(proven, kWiderThanRefined) == StatusCode::kOk && has_consensus())
        return StatusCode::kOk;
    }
    ransac_.let_all_lead();
    return find_leading();
  }

  // The motion of the matches that lead. Starts from the prediction, if that was estimated. Otherwise, and if
  // its consensus is too small, RANSAC finds the start.
  StatusCode find_leading() {
    if (start_.estimated) {
      const StatusCode status = approach_from(*start_.prediction, kWiderThanEstimated);
      if (status != StatusCode::kOk && status != StatusCode::kNoConsensus) return status;
      if (status == StatusCode::kOk && has_consensus()) return status;
    }
    Se3 found;
    if (!ransac_.run(seed_, start_.prediction, found, estimate_.ransac)) return StatusCode::kNoConsensus;
    return approach_from(found, kWiderThanRefined);
  }

  // Takes another motion in the place of T_ if T_ explains too little or a prior contradicts it, and if the
  // other one is better. apart: difference between the two, if they explain about the same.
  void look_beside(Vector6& apart) {
    const double covered = ransac_.covered();
    estimate_.contradicted = contradict(terms_, T_, solving_.references);
    if (!start_.search_beside || !(covered < kWorldAtRest || estimate_.contradicted)) return;
    const Se3 first = T_;
    const NuisanceParameters shared = shared_;
    solving_.first_references = solving_.references;
    ransac_.keep_consensus();
    Se3 other = T_;
    const bool found = ransac_.run_beside(seed_, start_.prediction, other, estimate_.ransac) &&
                       approach_from(other, kWiderThanRefined) == StatusCode::kOk && has_consensus();
    const double covered_by_other = found ? ransac_.covered() : 0;
    if (!estimate_.contradicted && are_comparable(covered, covered_by_other)) apart = boxminus(T_, first);
    const double least = estimate_.contradicted ? kShareOfUncontradicted : covered;
    estimate_.is_other = covered_by_other > least && ransac_.consensus_fixes_motion(seed_);
    if (estimate_.is_other) {
      estimate_.contradicted = false;
    } else {
      T_ = first;
      shared_ = shared;
      solving_.references = solving_.first_references;
      ransac_.restore_consensus();
    }
  }

  // Writes the motion and its covariance, if the consensus determines them.
  StatusCode conclude(const Vector6& apart) {
    estimate_.references = solving_.problem.references();
    // An undetermined motion does not converge either. kDegenerate is tested first because it is the cause.
    if (!T_.is_finite() || !ransac_.consensus_fixes_motion(seed_) ||
        !invert_information(solving_.solver.hessian(), config_, estimate_.C_H))
      return StatusCode::kDegenerate;
    // kStalled counts as converged: no step lowers the cost any further.
    if (!converged(estimate_.lm.status) && estimate_.lm.status != LmStatus::kStalled)
      return StatusCode::kNotConverged;
    if (start_.find_shifts && (start_.find_shifts_of_other || !estimate_.is_other)) find_shifts();
    estimate_.contain(apart);
    estimate_.T_current_reference = T_;
    estimate_.motions = motions_to_current(T_, solving_.references);
    return StatusCode::kOk;
  }

  // What each kind of landmark says: by how much the motion would differ if this kind decided, a
  // ⊞-perturbation of T_. Only its matches with the base count, because the poses of the other references are
  // themselves compromises of all kinds. The shifts are divided by the root of the number of kinds: Σ shift
  // shiftᵀ is then the covariance of the mixture in which each kind is equally likely to be right.
  [[gnu::noinline]] void find_shifts() {
    int kinds = 0;
    ransac_.keep_consensus();
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      CostTerm& term = terms_[i];
      if (term.reference() != 0 || term.kind() == LandmarkKind::kNone) continue;
      ++kinds;
      estimate_.shifts.col(static_cast<int>(term.kind())) = shift_of(term, kernels_[i]);
    }
    ransac_.restore_consensus();
    if (kinds > 0) estimate_.shifts /= sqrt(static_cast<double>(kinds));
  }

  // Matches of a kind that contradict T_ may agree with each other. So the consensus of the kind is found
  // anew, in rounds that lead away from T_, each with one Gauss–Newton step. Surfaces have one round: they
  // are judged by a gate of their own (SurfaceConstraints).
  Vector6 shift_of(CostTerm& term, const RobustKernel& kernel) {
    Matrix6 hold = kFavoured * estimate_.C_H;
    for (int k = 0; k < 6; ++k) hold(k, k) += k < 3 ? kHeld_m * kHeld_m : kHeld_rad * kHeld_rad;
    PriorConstraint held(T_, hold);
    CostTerm* const alone[] = {&term, &held};
    MotionProblem::Kernels kernels;
    kernels[0] = kernel;
    Se3 T = T_;
    for (const double scale : kScalesAlone) {
      if (term.kind() == LandmarkKind::kSurfaces && scale > 1) continue;
      ransac_.judge(T, scale, term);
      solving_.problem.start(CostTerms({}, alone), solving_.references, shared_, kernels, T);
      (void)solving_.solve(LmOptions::one_step());
      T = solving_.problem.T_current_reference();
    }
    return boxminus(T, T_);
  }

  RobustLoss loss() const { return config_.robust ? RobustLoss::kHuber : RobustLoss::kNone; }

  const CostTerms& terms_;
  const MotionReferences& references_;
  const MotionConfig& config_;
  std::uint64_t seed_;
  const MotionStart& start_;
  MotionSolver& solving_;
  MotionEstimate& estimate_;
  MotionProblem::Kernels kernels_;
  Ransac ransac_;
  NuisanceParameters shared_;
  Se3 T_;
};

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
  estimate.status = StatusCode::kOutOfMemory;
  if (scratch.size() == matches && !solver.empty()) {
    solver[0].references = references;
    estimate.status =
        ConsensusSolver(sets, terms, references, config, seed, start, scratch, solver[0], estimate).solve(lm);
  }
  if (estimate.status != StatusCode::kOk) {
    clear_flags(terms);
    forget_motion(estimate);
  }
  count_inliers(terms, estimate);
}

}  // namespace plvo
