// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/ransac.hpp"

#include <algorithm>

#include "plvo/math/chi_square.hpp"
#include "plvo/motion/minimal_set.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/motion/neighbourhoods.hpp"

namespace plvo {
namespace {

// A local refinement uses every n-th match, about this many in total. The resulting motion is far more
// precise than a single match, and the cost does not grow with the number of matches.
constexpr std::size_t kRefinementMatches = 96;
// It also uses only every n-th sample of surfaces. The estimate of the motion uses all of them.
constexpr std::size_t kRefinementSurfaceStride = 4;
// Scales of the thresholds in the refinement rounds. A motion from three matches is less precise than a
// match, so the first rounds accept three and two times the distance.
constexpr double kRoundScales[] = {9, 4, 1};
// A hypothesis that is not yet refined is scored with thresholds scaled by kFreshScale. To be refined it must
// beat all previous unrefined ones and reach kFreshShare of the best refined one's score at the same
// thresholds.
constexpr double kFreshScale = 4;
constexpr double kFreshShare = 0.5;
// Maximum number of sets drawn from the consensus to find one that is not degenerate.
constexpr int kDegeneracyDraws = 200;
// run_beside: a motion is only of interest if it explains this share of the remaining matches. A hypothesis
// is dropped unless at least kLeastPromising of kTested of them agree with it (bail-out test: Capel, "An
// effective bail-out test for RANSAC consensus scoring", BMVC 2005).
constexpr double kShareBeside = 0.4;
constexpr std::size_t kTested = 16;
constexpr int kLeastPromising = 5;
// New matches are not doubted if they are fewer than this share of the proven ones: they cannot outvote them.
constexpr double kFewNew = 0.25;
constexpr double kInlierProbability = 0.99;  // that a true match of any kind passes the χ² test
constexpr double kRansacConfidence = 0.999;  // that a set of true matches was drawn before stopping

}  // namespace

Ransac::Ransac(std::span<ConstraintSet* const> sets, const CostTerms& terms,
               const MotionReferences& references, const MotionConfig& config,
               const MotionProblem::Kernels& kernels, std::span<RansacCandidate> scratch,
               MotionSolver& solver)
    : sets_(sets),
      terms_(terms),
      references_(references),
      config_(config),
      kernels_(kernels),
      solver_(solver) {
  std::size_t n = 0;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    const ConstraintSet& set = *sets_[s];
    threshold_[s] = chi_square_quantile(set.dof(), kInlierProbability);
    for (std::size_t i = 0; i < set.size() && n < scratch.size(); ++i)
      if (set.usable(i))
        scratch[n++] = {static_cast<std::uint16_t>(s & 15), 0, 1, 0, static_cast<std::uint16_t>(i), 0};
  }
  candidates_ = leading_ = judged_ = scratch.first(n);
  weigh();
}

bool Ransac::let_proven_lead() {
  for (RansacCandidate& candidate : candidates_)
    candidate.leads = sets_[candidate.set]->extent(candidate.index).record.proven() ? 1 : 0;
  gather_leading();
  const auto others = static_cast<double>(candidates_.size() - leading());
  if (static_cast<int>(leading()) >= config_.min_inliers &&
      others >= kFewNew * static_cast<double>(leading()))
    return true;
  let_all_lead();
  return false;
}

void Ransac::let_all_lead() {
  for (RansacCandidate& candidate : candidates_) candidate.leads = 1;
  gather_leading();
}

// Moves the candidates that lead to the front.
void Ransac::gather_leading() {
  std::size_t n = 0;
  for (std::size_t k = 0; k < candidates_.size(); ++k)
    if (candidates_[k].leads != 0) std::swap(candidates_[k], candidates_[n++]);
  leading_ = candidates_.first(n);
}

// Not inlined: the cells would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] void Ransac::weigh() {
  Coverage coverage;
  for (std::size_t reference = 0; reference < kMaxReferences; ++reference) {
    const auto each = [&](const auto& visit) {
      for (RansacCandidate& candidate : candidates_)
        if (const ConstraintSet& set = *sets_[candidate.set]; set.reference() == reference)
          visit(candidate, set.extent(candidate.index));
    };
    coverage.clear();
    each([&](RansacCandidate& candidate, const Extent& extent) {
      candidate.cell = static_cast<std::uint16_t>(ImageCells::at(extent.middle) & (ImageCells::kCount - 1));
      coverage.count(extent);
    });
    each([&](RansacCandidate& candidate, const Extent& extent) {
      candidate.evidence = static_cast<float>(coverage.evidence(extent));
      evidence_ += static_cast<double>(candidate.evidence);
    });
  }
}

bool Ransac::most_leading_agree() const {
  std::size_t agreeing = 0;
  for (const RansacCandidate& candidate : leading_)
    agreeing += sets_[candidate.set]->inliers()[candidate.index];
  return 2 * agreeing > leading();
}

double Ransac::covered() const {
  double inliers = 0;
  for (const RansacCandidate& candidate : candidates_)
    if (sets_[candidate.set]->inliers()[candidate.index] != 0)
      inliers += static_cast<double>(candidate.evidence);
  return inliers / evidence_;
}

bool Ransac::run(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary) {
  start(Gain::kMatch, summary);
  Se3 best;
  if (prediction != nullptr && prediction->is_finite()) consider(*prediction, best, summary);
  sample(seed, leading(), prediction != nullptr ? prediction->R : Matrix3::Identity(), best, summary);
  if (!(summary.score > 0)) return false;
  T = best;
  return true;
}

bool Ransac::run_beside(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary) {
  const std::size_t rest = move_inliers_back();
  start(Gain::kEvidence, summary);
  Se3 best;
  rate(T, best, summary);
  bool found = prediction != nullptr && prediction->is_finite() && consider(*prediction, best, summary);
  if (sample(seed, rest, T.R, best, summary)) found = true;
  if (found) T = best;
  return found;
}

void Ransac::start(Gain gain, RansacSummary& summary) {
  summary = {};
  gain_ = gain;
  fresh_to_beat_ = 0;
  inliers_ = 0;
}

// Draws minimal sets from the first n candidates, until one of true matches alone was probably among them.
// Returns true if a hypothesis became the best.
bool Ransac::sample(std::uint64_t seed, std::size_t n, const Matrix3& R_expected, Se3& best,
                    RansacSummary& summary) {
  if (n < 3) return false;
  Random random(seed);
  bool found = false;
  int needed = iterations_needed();
  while (summary.iterations < needed && summary.draws < 4 * config_.max_ransac_iterations) {
    ++summary.draws;
    Se3 hypothesis;
    const MinimalSetStatus status =
        solve_minimal_set(draw(random, static_cast<std::uint32_t>(n)), R_expected, hypothesis);
    if (status == MinimalSetStatus::kDegenerate) continue;
    ++summary.iterations;
    if (status == MinimalSetStatus::kInconsistent || !hypothesis.is_finite()) continue;
    if (gain_ == Gain::kEvidence && !is_promising(hypothesis, n)) continue;
    if (!consider(hypothesis, best, summary)) continue;
    found = true;
    needed = iterations_needed();
  }
  return found;
}

// The bail-out test, by some of the first n candidates.
bool Ransac::is_promising(const Se3& T, std::size_t n) const {
  if (n < kTested) return true;
  const MotionsToCurrent motions = motions_to_current(T, references_);
  int agreeing = 0;
  for (std::size_t k = 0; k < kTested; ++k) {
    const RansacCandidate& candidate = candidates_[k * n / kTested];
    if (agrees(candidate, motions, kFreshScale)) ++agreeing;
  }
  return agreeing >= kLeastPromising;
}

// Moves the leading candidates that are no inliers to the front. Returns their number.
std::size_t Ransac::move_inliers_back() {
  std::size_t n = 0;
  for (std::size_t k = 0; k < leading(); ++k) {
    const RansacCandidate candidate = candidates_[k];
    if (sets_[candidate.set]->inliers()[candidate.index] != 0) continue;
    candidates_[k] = candidates_[n];
    candidates_[n++] = candidate;
  }
  return n;
}

// Draws three different matches of the first n, n ≥ 3, without a loop: random numbers below n, n − 1 and n −
// 2 that skip those already drawn.
std::array<Primitive, 3> Ransac::draw(Random& random, std::uint32_t n) const {
  const std::uint32_t a = random.below(n);
  std::uint32_t b = random.below(n - 1);
  std::uint32_t c = random.below(n - 2);
  if (b >= a) ++b;
  const std::uint32_t low = a < b ? a : b;
  const std::uint32_t high = a < b ? b : a;
  if (c >= low) ++c;
  if (c >= high) ++c;
  const auto primitive = [&](std::uint32_t k) {
    const ConstraintSet& set = *sets_[candidates_[k].set];
    Primitive match = set.primitive(candidates_[k].index);
    if (set.reference() == 0) return match;
    const Se3 T_base_reference = references_[set.reference()].T_reference_base.inverse();
    match.p_reference = T_base_reference * match.p_reference;
    if (match.shape == Primitive::Shape::kLine) match.d_reference = T_base_reference.R * match.d_reference;
    return match;
  };
  return {primitive(a), primitive(b), primitive(c)};
}

bool Ransac::consensus_fixes_motion(std::uint64_t seed) {
  if (terms_.fix_motion()) return true;
  std::uint32_t n = 0;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (sets_[candidates_[k].set]->inliers()[candidates_[k].index] == 0) continue;
    const RansacCandidate inlier = candidates_[k];
    candidates_[k] = candidates_[n];
    candidates_[n++] = inlier;
  }
  bool fixes = false;
  Random random(seed, 2);
  Se3 unused;
  for (int i = 0; i < kDegeneracyDraws && n >= 3 && !fixes; ++i)
    fixes = solve_minimal_set(draw(random, n), Matrix3::Identity(), unused) != MinimalSetStatus::kDegenerate;
  gather_leading();
  return fixes;
}

// Scores a hypothesis and refines it if it may become the best. If it does, stores it in `best` and returns
// true.
bool Ransac::consider(Se3 T, Se3& best, RansacSummary& summary) {
  const double fresh_score = score(T, fresh_to_beat_);
  if (!(fresh_score > fresh_to_beat_)) return false;
  fresh_to_beat_ = fresh_score;
  refine(T);
  return rate(T, best, summary);
}

// Scores a refined hypothesis. If it is the best, stores it in `best` and returns true.
bool Ransac::rate(const Se3& T, Se3& best, RansacSummary& summary) {
  if (gain_ == Gain::kEvidence && contradict(terms_, T, references_)) return false;
  double refined_score = 0;
  double refined_score_as_fresh = 0;
  int inliers = 0;
  const MotionsToCurrent motions = motions_to_current(T, references_);
  for (const RansacCandidate& candidate : leading_) {
    const double threshold = threshold_[candidate.set];
    const double gained = gain(candidate);
    const ConstraintSet& set = *sets_[candidate.set];
    const double s =
        set.mahalanobis_squared(candidate.index, motions[set.reference()], kFreshScale * threshold);
    if (s <= kFreshScale * threshold) refined_score_as_fresh += gained * (kFreshScale * threshold - s);
    if (s > threshold) continue;
    refined_score += gained * (threshold - s);
    ++inliers;
  }
  if (!(refined_score > summary.score)) return false;
  summary.score = refined_score;
  best = T;
  inliers_ = inliers;
  const double share = kFreshShare * refined_score_as_fresh;
  if (share > fresh_to_beat_) fresh_to_beat_ = share;
  return true;
}

// Score of an unrefined hypothesis, or 0 as soon as it cannot exceed to_beat.
double Ransac::score(const Se3& T, double to_beat) const {
  double possible = 0;
  const MotionsToCurrent motions = motions_to_current(T, references_);
  for (const RansacCandidate& candidate : leading_)
    possible += gain(candidate) * kFreshScale * threshold_[candidate.set];
  for (const RansacCandidate& candidate : leading_) {
    const double threshold = kFreshScale * threshold_[candidate.set];
    const ConstraintSet& set = *sets_[candidate.set];
    const double s = set.mahalanobis_squared(candidate.index, motions[set.reference()], threshold);
    // The match gains threshold − s instead of threshold, so the upper bound shrinks by s.
    possible -= gain(candidate) * (s < threshold ? s : threshold);
    if (possible <= to_beat) return 0;
  }
  return possible;
}

void Ransac::refine(Se3& T) {
  const int kept_inliers = inliers_;
  const std::size_t stride = leading() / kRefinementMatches + 1;
  for (const double scale : kRoundScales) {
    judge(T, scale, stride);
    if (inliers_ < 3) break;
    // A hypothesis does not need exact weights, so the references' poses are treated as exact.
    solver_.problem.start(terms_, references_, {}, kernels_, T, std::max(stride, kRefinementSurfaceStride),
                          true);
    (void)solver_.solve(LmOptions::one_step());
    T = solver_.problem.T_current_reference();
  }
  inliers_ = kept_inliers;
}

// Whether a match passes the χ² test with its threshold scaled.
bool Ransac::agrees(const RansacCandidate& candidate, const MotionsToCurrent& motions, double scale) const {
  const ConstraintSet& set = *sets_[candidate.set];
  const double threshold = scale * threshold_[candidate.set];
  return set.mahalanobis_squared(candidate.index, motions[set.reference()], threshold) <= threshold;
}

void Ransac::judge(const Se3& T, double scale, std::size_t stride) {
  inliers_ = 0;
  judged_ = scale > 1 || stride > 1 ? leading_ : candidates_;
  const MotionsToCurrent motions = motions_to_current(T, references_);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const RansacCandidate& candidate = candidates_[k];
    const std::uint8_t flag =
        k < judged_.size() && k % stride == 0 && agrees(candidate, motions, scale) ? 1 : 0;
    sets_[candidate.set]->inliers()[candidate.index] = flag;
    inliers_ += flag;
  }
}

[[gnu::noinline]] void Ransac::judge(const Se3& T, double scale, const CostTerm& set) {
  const MotionsToCurrent motions = motions_to_current(T, references_);
  for (const RansacCandidate& candidate : candidates_)
    if (ConstraintSet* judged = sets_[candidate.set]; judged == &set && candidate.evidence > 0)
      judged->inliers()[candidate.index] = agrees(candidate, motions, scale) ? 1 : 0;
}

void Ransac::keep_consensus() {
  for (RansacCandidate& candidate : candidates_)
    candidate.kept = sets_[candidate.set]->inliers()[candidate.index] & 1;
}

void Ransac::restore_consensus() {
  inliers_ = 0;
  for (const RansacCandidate& candidate : candidates_) {
    sets_[candidate.set]->inliers()[candidate.index] = candidate.kept;
    inliers_ += candidate.kept;
  }
}

// Not inlined: the counts would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] void Ransac::leave_isolated_out() {
  Neighbourhoods around;
  const auto is_inlier = [&](const RansacCandidate& candidate) {
    return sets_[candidate.set]->inliers()[candidate.index] != 0;
  };
  for (const RansacCandidate& candidate : judged_) around.count(candidate.cell, is_inlier(candidate));
  const auto is_isolated = [&](const RansacCandidate& candidate) {
    return is_inlier(candidate) && around.is_isolated(candidate.cell);
  };
  int left = inliers_;
  for (const RansacCandidate& candidate : judged_) left -= is_isolated(candidate) ? 1 : 0;
  if (left == inliers_ || 2 * left < inliers_ || left < config_.min_inliers) return;
  for (const RansacCandidate& candidate : judged_)
    if (is_isolated(candidate)) sets_[candidate.set]->inliers()[candidate.index] = 0;
  inliers_ = left;
}

int Ransac::iterations_needed() const {
  // 1 − (1 − w³)^k ≥ confidence, where w is the share of inliers among the matches that sets are drawn from.
  const double w =
      gain_ == Gain::kMatch ? static_cast<double>(inliers_) / static_cast<double>(leading()) : kShareBeside;
  const double all_good = w * w * w;
  if (!(all_good > 1e-9)) return config_.max_ransac_iterations;
  if (all_good > 1 - 1e-9) return 1;
  const double k = log(1 - kRansacConfidence) / log(1 - all_good);
  return k < config_.max_ransac_iterations ? static_cast<int>(k) + 1 : config_.max_ransac_iterations;
}

}  // namespace plvo
