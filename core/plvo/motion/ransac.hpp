// SPDX-License-Identifier: Apache-2.0
// RANSAC over mixed minimal sets (section 5.1 of the paper) for any kinds of features.
//
// Sampling: three different matches, uniformly over all usable matches of all kinds. The kinds drawn decide
// which of the four solvers runs. Before the first test all matches are equally likely to be good, so each
// kind is drawn in proportion to its number of matches, and a scene of one kind needs no special case.
// Scoring is MSAC (Torr & Zisserman 2000): a match at squared Mahalanobis distance s below its threshold
// gains threshold − s, its log-likelihood ratio against the threshold; the threshold is the quantile of
// χ²(dof) at one probability for all kinds. A hypothesis is dropped as soon as its remaining matches together
// cannot raise it to the best score; this does not change the result. A new best hypothesis is refined on its
// inliers by a few steps of the maximum-likelihood problem (LO-RANSAC, Chum, Matas & Kittler 2003).
//
// If a motion explains less of the evidence (coverage.hpp) than the camera's motion does in a world at rest,
// run_beside() searches for another one among the matches that it leaves.
//
// Either all matches lead the search, or those of proven landmarks alone (landmark_record.hpp). The others
// are then inliers only if they agree with the motion that was found.
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
  int iterations = 0;  // draws that are not degenerate
  double score = 0;    // score of the best hypothesis; 0 if there is none
};

// A match that may be an inlier.
struct RansacCandidate {
  std::uint16_t set : 4 = 0;    // its constraint set
  std::uint16_t kept : 1 = 0;   // its flag, as keep_consensus() found it
  std::uint16_t leads : 1 = 1;  // takes part in the search, not in the last test alone
  std::uint16_t cell : 10 = 0;  // its cell of the image
  std::uint16_t index = 0;
  float evidence = 0;
};
static_assert(ImageCells::kCount == 1 << 10 && kMaxConstraintSets <= 1 << 4);

constexpr std::span<RansacCandidate> take_ransac_scratch(Arena& memory, std::size_t max_matches) {
  return memory.take<RansacCandidate>("motion: candidates", max_matches);
}

class Ransac {
 public:
  // terms: what the refinements minimise, first the sets. scratch: one RansacCandidate for every match of all
  // sets; matches that do not fit are ignored. solver: used by the refinements; the caller may use it between
  // them. references and terms must outlive this object.
  Ransac(std::span<ConstraintSet* const> sets, const CostTerms& terms, const MotionReferences& references,
         const MotionConfig& config, const MotionProblem::Kernels& kernels,
         std::span<RansacCandidate> scratch, MotionSolver& solver);

  // Number of all usable matches, and of those that lead. At first all do.
  std::size_t usable() const { return candidates_.size(); }
  std::size_t leading() const { return leading_.size(); }
  // Lets only the matches of proven landmarks lead. Returns false, and lets all lead, if the proven are too
  // few for a consensus, or the others too few to outvote them. Both functions reorder the scratch.
  bool let_proven_lead();
  void let_all_lead();

  // Writes the motion of the most matches to T. Returns false if no hypothesis has a score above zero.
  bool run(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary);
  // Searches for a motion with more evidence than T, the motion of the flagged inliers. A motion that a term
  // contradicts has no evidence. Sets are drawn from the other matches; the prediction, if any, is the first
  // hypothesis. Returns false, and leaves T, if no better one is found. Reorders the scratch.
  bool run_beside(std::uint64_t seed, const Se3* prediction, Se3& T, RansacSummary& summary);

  // Sets the inlier flag of every match by the χ² test under T with the thresholds scaled by `scale`. With a
  // scale above 1, the test leads to a motion: only matches that lead can pass.
  void judge(const Se3& T, double scale) { judge(T, scale, 1); }
  // The same for the matches of one set that have evidence, whether they lead or not. The other flags stay.
  void judge(const Se3& T, double scale, const CostTerm& set);
  // Keeps the flags of the matches, and writes them again.
  void keep_consensus();
  void restore_consensus();
  // Clears the flags of the inliers that are isolated among outliers (neighbourhoods.hpp), unless most are.
  void leave_isolated_out();
  int inliers() const { return inliers_; }
  // Whether most of the leading matches are flagged.
  bool most_leading_agree() const;
  // Share of the evidence of all usable matches that the flagged inliers have.
  double covered() const;
  // The evidence of all matches together, in m.
  double evidence() const { return evidence_; }

  // Returns false if no minimal set drawn from the flagged inliers determines the motion, and no other term
  // does: all lines parallel, all points on a line. The covariance does not reveal this, since noise in the
  // directions of parallel lines looks like information. Reorders the scratch.
  bool consensus_fixes_motion(std::uint64_t seed);

 private:
  // The quantity to which the score of an inlier is proportional.
  enum class Gain : std::uint8_t {
    kMatch,     // run(): every match counts the same
    kEvidence,  // run_beside(): by its evidence, unless a term contradicts the motion
  };
  void weigh();
  void gather_leading();
  void start(Gain gain, RansacSummary& summary);
  bool sample(std::uint64_t seed, std::size_t n, const Matrix3& R_expected, Se3& best,
              RansacSummary& summary);
  std::size_t move_inliers_back();
  bool is_promising(const Se3& T, std::size_t n) const;
  double gain(const RansacCandidate& candidate) const {
    return gain_ == Gain::kMatch ? 1 : static_cast<double>(candidate.evidence);
  }
  std::array<Primitive, 3> draw(Random& random, std::uint32_t n) const;
  double score(const Se3& T, double to_beat) const;
  bool consider(Se3 T, Se3& best, RansacSummary& summary);
  bool rate(const Se3& T, Se3& best, RansacSummary& summary);
  // Refines T on a subset of the matches that agree with it, and writes the inlier flags.
  void refine(Se3& T);
  // Judges every stride-th match and clears the flags of the others.
  void judge(const Se3& T, double scale, std::size_t stride);
  bool agrees(const RansacCandidate& candidate, const MotionsToCurrent& motions, double scale) const;
  int iterations_needed() const;

  std::span<ConstraintSet* const> sets_;
  const CostTerms& terms_;
  const MotionReferences& references_;
  MotionConfig config_;
  MotionProblem::Kernels kernels_;
  MotionSolver& solver_;
  std::span<RansacCandidate> candidates_;  // first those that lead
  std::span<RansacCandidate> leading_;
  std::span<RansacCandidate> judged_;  // by the last judge()
  int inliers_ = 0;
  double evidence_ = 0;  // of all candidates
  Gain gain_ = Gain::kMatch;
  double fresh_to_beat_ = 0;  // score that the next hypothesis must exceed to be refined
  std::array<double, kMaxConstraintSets> threshold_{};
};

}  // namespace plvo
