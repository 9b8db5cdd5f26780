// SPDX-License-Identifier: Apache-2.0
// The joint maximum-likelihood problem (21)–(23) in the form the Levenberg–Marquardt solver wants: six
// parameters, every kind of constraint eliminates its own landmarks. H is C_P⁻¹ + C_L⁻¹ + …, equation (26),
// kept by kind.
#pragma once

#include <array>
#include <span>

#include "plvo/math/levenberg_marquardt.hpp"
#include "plvo/motion/common_mode_error.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

inline constexpr std::size_t kMaxReferences = 3;
// Theirs, and after them that of the last good frame, which a sensed motion starts from: it may be none of
// them.
inline constexpr std::size_t kMaxPoses = kMaxReferences + 1;
// Sets: points and lines of each reference, and a motion that other sensors tell; then surfaces of each.
inline constexpr std::size_t kMaxConstraintKinds = 3 * kMaxReferences + 1;
// Of the first sets the information is kept: of all but surfaces.
inline constexpr std::size_t kInformedKinds = 2 * kMaxReferences + 1;

// A frame that matches are with. The motion is solved against the base, reference 0; the pose of any other
// relative to it is known with a covariance (of the ⊞-perturbation of T_reference_base). It is estimated with
// the motion and eliminated: with the Schur complement H of the reference's own motion that leaves
// (H⁻¹ + B C Bᵀ)⁻¹, B the derivative of T_current_reference with respect to the perturbation.
struct MotionReference {
  Se3 T_reference_base;
  Matrix6 covariance = Matrix6::Zero();
  // Where it is an estimate: by L moved from what was known, C = L Lᵀ.
  Vector6 moved = Vector6::Zero();
};
using MotionReferences = std::array<MotionReference, kMaxPoses>;

// T_current_reference of every reference, of one T_current_base.
using MotionsToCurrent = std::array<Se3, kMaxPoses>;
MotionsToCurrent motions_to_current(const Se3& T_current_base, const MotionReferences& references);

class MotionProblem {
 public:
  using Kernels = std::array<RobustKernel, kMaxConstraintKinds>;
  // One kernel per set; made once, for the quantile in it takes longer than a residual.
  static Kernels make_kernels(std::span<ConstraintSet* const> sets, RobustLoss loss);

  // For start(): it takes 16 kB, so the core has one in the arena for one estimate after the other.
  MotionProblem() = default;
  MotionProblem(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                const NuisanceParameters& shared, const Kernels& kernels, const Se3& T) {
    start(sets, references, shared, kernels, T);
  }
  // Over the inliers flagged in each set (at most kMaxConstraintKinds sets), starting at T and at the shared
  // errors' value. every: see ConstraintSet::begin(). exact_poses: the references' covariances are taken for
  // zero.
  void start(std::span<ConstraintSet* const> sets, const MotionReferences& references,
             const NuisanceParameters& shared, const Kernels& kernels, const Se3& T, std::size_t every = 1,
             bool exact_poses = false);

  // The shared errors, and the references' poses, are eliminated like landmarks: moved to their optimum for
  // the candidate, H and g their Schur complement. All weights are those at the state they are moved from.
  double linearize(const Vector6& step, Matrix6& H, Vector6& g);
  void accept();
  // Takes one more step unseen, a last one that is small, or that another start() follows: the motion and the
  // shared errors are then where it leads; the references' poses, and all that is said of the accepted
  // state's information, stay.
  void advance(const Vector6& step);

  const Se3& T_current_reference() const { return T_; }
  // With their poses as estimated at the accepted state: a start() with them goes on from there.
  const MotionReferences& poses() const { return references_; }
  // At the accepted state, where the motion has this covariance.
  NuisanceEstimate shared(const Matrix6& covariance) const;
  // The Schur complement of one kind at the accepted state, the shared errors taken for known: C_P⁻¹ (14),
  // C_L⁻¹ (19). Of the first kInformedKinds sets.
  const Matrix6& information(std::size_t kind) const { return information_[kind]; }
  // Of all sets at the accepted state, the shared errors taken for known.
  const ReferenceInformation& references() const { return of_references_; }

 private:
  using SharedMatrix = Matrix<NuisanceParameters::kCount, NuisanceParameters::kCount>;
  using SharedGain = Matrix<NuisanceParameters::kCount, 6>;
  using PoseGain = Matrix<6, NuisanceParameters::kCount>;

  double add_reference(std::size_t r, const Se3& T);
  double add_kinds(std::size_t r, const Se3& T, bool& any);
  double bring_to_base(std::size_t r, const Se3& T);
  double eliminate_pose(std::size_t r, const Matrix6& root);
  double eliminate_shared();

  std::span<ConstraintSet* const> sets_;
  MotionReferences references_;
  std::array<Matrix6, kMaxPoses> root_;  // L of the references' covariances
  // The candidate's moved; and how that follows the shared errors.
  std::array<Vector6, kMaxPoses> candidate_moved_;
  std::array<PoseGain, kMaxPoses> pose_gain_;
  Kernels kernels_;
  // What a kind's inliers weigh together, as a share of what as many independent ones would.
  std::array<double, kMaxConstraintKinds> share_{};
  Se3 T_, candidate_;
  NuisanceParameters shared_;
  NuisanceParameters::Vector candidate_shared_;
  // Of the shared errors given the motion: their covariance, and how they follow the motion.
  SharedMatrix inverse_, candidate_inverse_;
  SharedGain gain_, candidate_gain_;
  std::array<Matrix6, kInformedKinds> information_, candidate_information_;
  ReferenceInformation of_references_, candidate_of_references_;
  // What a linearisation sums up: of all references, of one, of one kind of it.
  JointInformation sum_, of_reference_, of_kind_;
};

// What RANSAC's refinements and the estimate after them use in turns, and the references as they are known so
// far.
struct MotionSolver {
  MotionReferences references;
  MotionProblem problem;
  LevenbergMarquardt<6> solver;
  // The last step, which the solver would have tried next, is taken unseen.
  LmSummary solve(const LmOptions& options);
};

}  // namespace plvo
