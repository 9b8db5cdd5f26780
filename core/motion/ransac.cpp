// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/ransac.hpp"

#include "plvo/base/random.hpp"
#include "plvo/math/chi_square.hpp"
#include "plvo/motion/minimal_set.hpp"
#include "plvo/motion/motion_problem.hpp"

namespace plvo {
namespace {

// A local refinement looks at this many inliers at most: enough for a motion far more precise than a match.
constexpr int kRefinementInliers = 96;
// A motion from three matches is less precise than a match: the first rounds forgive it three and two times
// the distance.
constexpr double kRoundScales[] = {9, 4, 1};
// A fresh hypothesis is scored with thresholds this much wider, and must beat every fresh one before it and
// reach this share of what the best refined one scores so.
constexpr double kFreshScale = 4;
constexpr double kFreshShare = 0.5;
constexpr int kRefinementSteps = 3;

bool joins_minimal_sets(const ConstraintSet& set, std::size_t i) {
  return set.primitive(i).shape != Primitive::Shape::kNone;
}

}  // namespace

Ransac::Ransac(std::span<ConstraintSet* const> sets, const RansacOptions& options, RobustLoss loss,
               std::span<Candidate> scratch)
    : sets_(sets.first(sets.size() < kMaxConstraintKinds ? sets.size() : kMaxConstraintKinds)),
      options_(options),
      loss_(loss) {
  for (const bool samplable : {true, false})
    for (std::size_t kind = 0; kind < sets_.size(); ++kind) {
      const ConstraintSet& set = *sets_[kind];
      threshold_[kind] = chi_square_quantile(set.dof(), options_.inlier_probability);
      for (std::size_t i = 0; i < set.size() && usable_ < scratch.size(); ++i) {
        if (!set.usable(i) || joins_minimal_sets(set, i) != samplable) continue;
        scratch[usable_++] = {static_cast<std::uint8_t>(kind), static_cast<std::uint16_t>(i)};
        if (samplable) ++samplable_;
      }
    }
  candidates_ = scratch.first(usable_);
}

bool Ransac::run(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary) {
  summary = {};
  fresh_to_beat_ = 0;
  Se3 best;
  if (prediction != nullptr && prediction->is_finite()) consider(*prediction, best, summary);
  if (samplable_ >= 3) {
    const Matrix3 R_expected = prediction != nullptr ? prediction->R : Matrix3::Identity();
    Random random(seed);
    const auto n = static_cast<std::uint32_t>(samplable_);
    int needed = iterations_needed();
    while (summary.iterations < needed && summary.draws < 4 * options_.max_iterations) {
      ++summary.draws;
      // Three different numbers below n without a loop: draw from n, n − 1, n − 2 and step over those already
      // drawn.
      std::uint32_t a = random.below(n);
      std::uint32_t b = random.below(n - 1);
      std::uint32_t c = random.below(n - 2);
      if (b >= a) ++b;
      const std::uint32_t low = a < b ? a : b;
      const std::uint32_t high = a < b ? b : a;
      if (c >= low) ++c;
      if (c >= high) ++c;
      const auto primitive = [&](std::uint32_t k) {
        return sets_[candidates_[k].kind]->primitive(candidates_[k].index);
      };
      Se3 hypothesis;
      const MinimalSetStatus status =
          solve_minimal_set({primitive(a), primitive(b), primitive(c)}, R_expected, hypothesis);
      if (status == MinimalSetStatus::kDegenerate) continue;
      ++summary.iterations;
      if (status == MinimalSetStatus::kInconsistent || !hypothesis.is_finite()) continue;
      if (consider(hypothesis, best, summary)) needed = iterations_needed();
    }
  }
  if (!(summary.score > 0)) return false;
  T = best;
  return true;
}

// Scores a hypothesis; if it is the best so far, refines it, keeps it and returns true.
bool Ransac::consider(Se3 T, Se3& best, RansacSummary& summary) {
  ++summary.hypotheses;
  const double fresh_score = score(T, kFreshScale, fresh_to_beat_);
  if (!(fresh_score > fresh_to_beat_)) return false;
  fresh_to_beat_ = fresh_score;
  ++summary.refinements;
  refine(T);
  const double new_score = score(T, 1, summary.score);
  if (!(new_score > summary.score)) return false;
  summary.score = new_score;
  best = T;
  judge(best);
  const double share = kFreshShare * score(T, kFreshScale, 0);
  if (share > fresh_to_beat_) fresh_to_beat_ = share;
  return true;
}

double Ransac::score(const Se3& T, double scale, double to_beat) const {
  double possible = 0;
  for (const Candidate& candidate : candidates_) possible += scale * threshold_[candidate.kind];
  for (const Candidate& candidate : candidates_) {
    const double threshold = scale * threshold_[candidate.kind];
    const double s = sets_[candidate.kind]->mahalanobis_squared(candidate.index, T, threshold);
    // A gain of threshold − s instead of threshold: what is still possible shrinks by s.
    possible -= s < threshold ? s : threshold;
    if (possible <= to_beat) return 0;
  }
  return possible;
}

void Ransac::refine(Se3& T) {
  for (const double scale : kRoundScales) {
    judge(T, scale);
    if (inliers_ < 3) return;
    // Every stride-th inlier, by integer arithmetic, when there are many.
    const int stride = (inliers_ + kRefinementInliers - 1) / kRefinementInliers;
    int k = 0;
    for (const Candidate& candidate : candidates_) {
      std::uint8_t& flag = sets_[candidate.kind]->inliers()[candidate.index];
      if (flag != 0 && k++ % stride != 0) flag = 0;
    }
    MotionProblem problem(sets_, loss_, T);
    LevenbergMarquardt<6> solver;
    LmOptions options;
    options.max_iterations = kRefinementSteps;
    options.step_tolerance = 1e-4;
    (void)solver.solve(problem, options);
    T = problem.T_current_reference();
  }
}

bool Ransac::judge(const Se3& T, double scale) {
  bool changed = false;
  inliers_ = 0;
  for (const Candidate& candidate : candidates_) {
    ConstraintSet& set = *sets_[candidate.kind];
    const double threshold = scale * threshold_[candidate.kind];
    const std::uint8_t flag = set.mahalanobis_squared(candidate.index, T, threshold) <= threshold ? 1 : 0;
    std::uint8_t& old = set.inliers()[candidate.index];
    changed = changed || flag != old;
    old = flag;
    inliers_ += flag;
  }
  return changed;
}

int Ransac::iterations_needed() const {
  if (inliers_ < 3) return options_.max_iterations;
  // 1 − (1 − w³)^k ≥ confidence, w the share of inliers among the matches.
  const double w = static_cast<double>(inliers_) / static_cast<double>(usable_);
  const double all_good = w * w * w;
  if (all_good > 1 - 1e-9) return 1;
  const double k = log(1 - options_.confidence) / log(1 - all_good);
  return k < options_.max_iterations ? static_cast<int>(k) + 1 : options_.max_iterations;
}

}  // namespace plvo
