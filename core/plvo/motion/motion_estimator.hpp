// SPDX-License-Identifier: Apache-2.0
// Boxes 5 and 6 of the paper: estimates the motion between two frames and its covariance from putative
// matches of any kind. RANSAC over mixed minimal sets finds the consensus (ransac.hpp); the joint
// maximum-likelihood estimate refines it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/status.hpp"
#include "plvo/math/levenberg_marquardt.hpp"
#include "plvo/motion/constraint_set.hpp"
#include "plvo/motion/line_constraints.hpp"
#include "plvo/motion/motion_config.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/motion/point_constraints.hpp"
#include "plvo/motion/ransac.hpp"
#include "plvo/motion/surface_constraints.hpp"

namespace plvo {

struct MotionEstimate {
  // kOk; kTooFewFeatures: fewer usable matches than three or than min_inliers; kNoConsensus; kDegenerate;
  // kNotConverged; kOutOfMemory. Every number here is finite whatever the status; unless it is kOk, T is the
  // identity and C_H is kUnknownVariance on the diagonal.
  StatusCode status = StatusCode::kTooFewFeatures;
  Se3 T_current_reference;  // X' = R X + t, equation (11)
  // Evidence (coverage.hpp) that the motion explains, in m, and its share of that of all matches.
  double evidence = 0;
  double explained = 0;
  // Whether this is not the first motion with a consensus, but another one that has more evidence or, where a
  // prior contradicts the first, is not contradicted.
  bool is_other = false;
  // Whether a prior contradicts the first motion, and no other motion was taken in its place: the other
  // sensors measured a different one.
  bool contradicted = false;
  MotionsToCurrent motions;  // T_current_reference for every reference; their poses are estimated jointly
  // C_H (23): covariance of the ⊞-perturbation (v, ω) of T_current_reference with the robust weights, (Σ w Jᵀ
  // Σ⁻¹ J)⁻¹; m², m rad, rad². contain() adds the difference from another motion.
  Matrix6 C_H = kUnknownVariance * Matrix6::Identity();
  ReferenceInformation references;  // information of all terms, given the nuisance parameters
  // By how much the motion would differ (⊞-perturbation) if one kind of landmark had decided, over the root
  // of the number of kinds.
  OfEachKind shifts = OfEachKind::Zero();
  NuisanceEstimate shared;               // zero unless kOk
  std::array<int, kMaxTerms> inliers{};  // the flags are in each term's inliers()
  RansacSummary ransac;
  LmSummary lm;

  // Adds another motion that explains nearly as much (are_comparable) to the covariance. apart:
  // ⊞-perturbation between the two.
  void contain(const Vector6& apart) { C_H += apart.lazyProduct(apart.transpose()); }

  static constexpr double kUnknownVariance = 1e6;
};

// Initial values of the motion and of the nuisance parameters of the current frame. estimated: the prediction
// was already estimated from these frames; hypotheses are then drawn only if the matches disagree with it.
struct MotionStart {
  MotionStart(const Se3* T_predicted, const NuisanceParameters& nuisance_parameters = {},
              bool is_estimated = false)
      : prediction(T_predicted),
        shared(nuisance_parameters),
        estimated(is_estimated && T_predicted != nullptr) {}
  const Se3* prediction;
  NuisanceParameters shared;
  bool estimated;
  // Another motion is searched if this one explains too little.
  bool search_beside = true;
  // What each kind says is found (MotionEstimate::shifts); the second is for a result that is another motion
  // (is_other).
  bool find_shifts = true;
  bool find_shifts_of_other = true;
  // The matches were registered near the prediction. Outliers are then mostly parts of an object that moves,
  // and inliers among them are left out (neighbourhoods.hpp). Otherwise outliers are mostly wrong matches.
  bool registered = false;
};

// Fills `estimate`. sets: at most kMaxConstraintSets, in a fixed order. others: terms that RANSAC does not
// judge, such as a prior. The inlier flags of all are written (all zero unless kOk); what else the terms
// hold depends on the last motion that was tried. references: the frames that the sets match with; the
// result is the motion from the base, reference 0. start.prediction, if any, is the first hypothesis, and
// it decides between rotations that perpendicular lines cannot distinguish. The result is bitwise
// reproducible. Scratch memory (take_ransac_scratch, take_solver) is taken from the arena and returned; if
// the arena is too small, the status is kOutOfMemory. The status is also kDegenerate if a standard
// deviation exceeds its bound in MotionConfig, if the information matrix (scaled to a unit diagonal) has
// an eigenvalue ratio below 1e-10, or if every minimal set drawn from the consensus is degenerate: all
// lines parallel, all points on a line, …
void estimate_motion(std::span<ConstraintSet* const> sets, std::span<CostTerm* const> others,
                     const MotionReferences& references, const MotionConfig& config, const LmOptions& lm,
                     std::uint64_t seed, const MotionStart& start, Arena& arena, MotionEstimate& estimate);

// The same, with the result returned on the stack.
inline MotionEstimate estimate_motion(std::span<ConstraintSet* const> sets, std::span<CostTerm* const> others,
                                      const MotionReferences& references, const MotionConfig& config,
                                      const LmOptions& lm, std::uint64_t seed, const MotionStart& start,
                                      Arena& arena) {
  MotionEstimate estimate;
  estimate_motion(sets, others, references, config, lm, seed, start, arena, estimate);
  return estimate;
}

constexpr std::span<MotionSolver> take_solver(Arena& memory) {
  return memory.take<MotionSolver>("motion: solver", 1);
}

// Allocates what points, lines and surfaces (of each reference) and estimate_motion take
// between mark and rewind. Used to compute the size of the arena.
constexpr void size_motion(Arena& memory, std::size_t references, std::size_t max_points,
                           std::size_t max_lines, std::size_t max_surfaces = 0) {
  const ScratchScope scope(memory);
  for (std::size_t r = 0; r < references; ++r) {
    (void)PointConstraints::Workspace::take(memory, max_points);
    (void)LineConstraints::Workspace::take(memory, max_lines);
    (void)SurfaceConstraints::Workspace::take(memory, max_surfaces);
  }
  (void)take_ransac_scratch(memory, references * (max_points + max_lines));
  (void)take_solver(memory);
}

}  // namespace plvo
