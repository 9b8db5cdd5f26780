// SPDX-License-Identifier: Apache-2.0
// RANSAC over mixed minimal sets (section 5.1 of the paper), for any kinds of constraints.
//
// Sampling: three different matches, uniformly over all usable matches of all kinds; the kinds drawn decide
// which of the four solvers runs. Every match is as likely to be good as any other as far as we know before
// the first test, so this makes the kinds appear in proportion to how much of the evidence they are, and a
// scene of one kind needs no special case. Scoring is MSAC (Torr & Zisserman 2000): a match at squared
// Mahalanobis distance s below its threshold gains threshold − s, its log-likelihood ratio against the
// threshold; the threshold is the quantile of χ²(dof) at one probability for all kinds. A hypothesis is
// dropped as soon as all its remaining matches together cannot bring it to the best score: this loses
// nothing. A new best is refined on its inliers by a few steps of the maximum-likelihood problem (LO-RANSAC,
// Chum, Matas & Kittler 2003).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/random.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/constraint_set.hpp"
#include "plvo/motion/motion_config.hpp"
#include "plvo/motion/motion_problem.hpp"

namespace plvo {

struct RansacSummary {
  int draws = 0;       // sets drawn
  int iterations = 0;  // of these, not degenerate
  int hypotheses = 0;  // of these, rigid within their uncertainty, hence solved and scored
  int refinements = 0;
  double score = 0;  // of the best one; 0 when there is none
};

// A match that may be an inlier.
struct RansacCandidate {
  std::uint8_t kind = 0;
  std::uint16_t index = 0;
};

constexpr std::span<RansacCandidate> take_ransac_scratch(Arena& memory, std::size_t max_matches) {
  return memory.take<RansacCandidate>("motion: candidates", max_matches);
}

class Ransac {
 public:
  // scratch holds a RansacCandidate for every match of all sets; what does not fit is not looked at. solver:
  // for the refinements, between which it may be used otherwise. The references must outlive it.
  Ransac(std::span<ConstraintSet* const> sets, const MotionReferences& references, const MotionConfig& config,
         const MotionProblem::Kernels& kernels, std::span<RansacCandidate> scratch, MotionSolver& solver);

  // Usable matches, all of them, and those that may form minimal sets.
  std::size_t usable() const { return usable_; }
  std::size_t samplable() const { return samplable_; }

  // The best motion found; false when no hypothesis scored at all.
  bool run(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary);

  // Sets the inlier flag of every match by the χ² test under T, with the thresholds scaled by `scale`.
  void judge(const Se3& T, double scale) { judge(T, scale, 1); }
  int inliers() const { return inliers_; }

  // False when no minimal set of the flagged inliers fixes the motion: all lines parallel, all points on a
  // line. The covariance cannot tell: noise in the directions of parallel lines looks like information.
  // Reorders the scratch.
  bool consensus_fixes_motion(std::uint64_t seed);

 private:
  std::array<Primitive, 3> draw(Random& random, std::uint32_t n) const;
  double score(const Se3& T, double to_beat) const;
  bool consider(Se3 T, Se3& best, RansacSummary& summary);
  // Brings T nearer by a part of the matches that agree with it, and writes the inlier flags.
  void refine(Se3& T);
  // Of every stride-th match; clears the other flags.
  void judge(const Se3& T, double scale, std::size_t stride);
  int iterations_needed() const;

  std::span<ConstraintSet* const> sets_;
  const MotionReferences& references_;
  MotionConfig config_;
  MotionProblem::Kernels kernels_;
  MotionSolver& solver_;
  std::span<RansacCandidate> candidates_;  // those that may form minimal sets first
  std::size_t usable_ = 0;
  std::size_t samplable_ = 0;
  int inliers_ = 0;
  double fresh_to_beat_ = 0;  // score that the next hypothesis must exceed to be refined
  std::array<double, kMaxConstraintKinds> threshold_{};
};

}  // namespace plvo
