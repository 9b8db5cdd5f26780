// SPDX-License-Identifier: Apache-2.0
// The joint maximum-likelihood problem (21)–(23) in the form that the Levenberg–Marquardt solver needs. It
// has six parameters; every term eliminates its own landmarks. H is C_P⁻¹ + C_L⁻¹ + …, equation (26).
#pragma once

#include <array>
#include <span>

#include "plvo/math/levenberg_marquardt.hpp"
#include "plvo/motion/common_mode_error.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

inline constexpr std::size_t kMaxReferences = 3;
// The poses of the references, followed by the pose of the last good frame, from which the propagated prior
// starts. That frame need not be one of the references.
inline constexpr std::size_t kLastGoodPose = kMaxReferences;
inline constexpr std::size_t kMaxPoses = kMaxReferences + 1;
// Points and lines of each reference.
inline constexpr std::size_t kMaxConstraintSets = 2 * kMaxReferences;
// These, the propagated prior, then the surfaces of each reference.
inline constexpr std::size_t kMaxTerms = kMaxConstraintSets + 1 + kMaxReferences;

// The terms of the cost, in a fixed order: the sets that RANSAC draws from, then all others. Terms beyond the
// capacity are left out.
class CostTerms {
 public:
  CostTerms() = default;
  explicit CostTerms(std::span<ConstraintSet* const> sets, std::span<CostTerm* const> others = {}) {
    for (ConstraintSet* set : sets) add(set);
    for (CostTerm* term : others) add(term);
  }
  std::size_t size() const { return count_; }
  CostTerm& operator[](std::size_t i) const { return *terms_[i]; }
  bool fix_motion() const {
    bool fix = false;
    for (std::size_t i = 0; i < count_; ++i) fix = fix || terms_[i]->fixes_motion();
    return fix;
  }

 private:
  void add(CostTerm* term) {
    if (count_ < kMaxTerms) terms_[count_++] = term;
  }
  std::array<CostTerm*, kMaxTerms> terms_{};
  std::size_t count_ = 0;
};

// A frame with which the current frame is matched. The motion is estimated relative to the base, reference 0.
// The pose of any other reference relative to the base is known with a covariance C (of the ⊞-perturbation of
// T_reference_base). It is estimated jointly with the motion and eliminated. If H is the Schur complement on
// the reference's own motion, the elimination leaves (H⁻¹ + B C Bᵀ)⁻¹, where B is the derivative of
// T_current_reference with respect to the perturbation.
struct MotionReference {
  Se3 T_reference_base;
  Matrix6 covariance = Matrix6::Zero();
  // Estimated displacement: the pose differs from its prior by L moved, with C = L Lᵀ.
  Vector6 moved = Vector6::Zero();
};
using MotionReferences = std::array<MotionReference, kMaxPoses>;

// T_current_reference of every reference, computed from T_current_base.
using MotionsToCurrent = std::array<Se3, kMaxPoses>;
MotionsToCurrent motions_to_current(const Se3& T_current_base, const MotionReferences& references);

// Whether a term contradicts the motion.
bool contradict(const CostTerms& terms, const Se3& T_current_base, const MotionReferences& references);

class MotionProblem {
 public:
  using Kernels = std::array<RobustKernel, kMaxTerms>;
  // One kernel per term. They are made once because computing the quantile takes longer than a residual.
  static Kernels make_kernels(const CostTerms& terms, RobustLoss loss);

  // To be followed by start(). The object takes 26 kB, so the core keeps one in the arena and reuses it.
  MotionProblem() = default;
  MotionProblem(const CostTerms& terms, const MotionReferences& references, const NuisanceParameters& shared,
                const Kernels& kernels, const Se3& T) {
    start(terms, references, shared, kernels, T);
  }
  // Sets up the problem over the inliers flagged in each term, starting at T and at the value of the nuisance
  // parameters. every: see CostTerm::begin(). exact_poses: the
  // references' covariances are treated as zero.
  void start(const CostTerms& terms, const MotionReferences& references, const NuisanceParameters& shared,
             const Kernels& kernels, const Se3& T, std::size_t every = 1, bool exact_poses = false);

  // Eliminates the nuisance parameters and the references' poses like landmarks: it moves them to their
  // optimum for the candidate; H and g are the Schur complement. All weights are those of the state that the
  // step starts from.
  double linearize(const Vector6& step, Matrix6& H, Vector6& g);
  void accept();
  // Takes one more step without evaluating the cost. The step must be small or another start() must follow.
  // Moves the motion and the nuisance parameters; the references' poses and the information of the accepted
  // state stay unchanged.
  void advance(const Vector6& step);

  const Se3& T_current_reference() const { return T_; }
  // The references with their poses as estimated at the accepted state. A start() with them continues from
  // there.
  const MotionReferences& poses() const { return references_; }
  // The nuisance parameters at the accepted state, given the covariance of the motion.
  NuisanceEstimate shared(const Matrix6& covariance) const;
  // The information of all terms at the accepted state, given the nuisance parameters.
  const ReferenceInformation& references() const { return of_references_; }

 private:
  using SharedMatrix = Matrix<NuisanceParameters::kCount, NuisanceParameters::kCount>;
  using SharedGain = Matrix<NuisanceParameters::kCount, 6>;
  using PoseGain = Matrix<6, NuisanceParameters::kCount>;

  double add_reference(std::size_t r, const Se3& T);
  double add_terms(std::size_t r, const Se3& T, bool& any);
  double bring_to_base(std::size_t r, const Se3& T);
  double eliminate_pose(std::size_t r, const Matrix6& root);
  double eliminate_shared();

  CostTerms terms_;
  MotionReferences references_;
  std::array<Matrix6, kMaxPoses> root_;  // L of the references' covariances
  // MotionReference::moved of the candidate, and its derivative with respect to the nuisance parameters.
  std::array<Vector6, kMaxPoses> candidate_moved_;
  std::array<PoseGain, kMaxPoses> pose_gain_;
  Kernels kernels_;
  // Weight of a term's inliers relative to the same number of independent ones.
  std::array<double, kMaxTerms> share_{};
  Se3 T_, candidate_;
  NuisanceParameters shared_;
  NuisanceParameters::Vector candidate_shared_;
  // Covariance of the nuisance parameters given the motion, and their derivative with respect to the motion.
  SharedMatrix inverse_, candidate_inverse_;
  SharedGain gain_, candidate_gain_;
  ReferenceInformation of_references_, candidate_of_references_;
  // Sums of a linearisation: over all references, over one reference, over one term without its share.
  JointInformation sum_, of_reference_, of_term_;
};

// The solver that RANSAC's refinements and the final estimate share, and the current estimate of the
// references.
struct MotionSolver {
  MotionReferences references;
  MotionReferences first_references;  // as estimated with the first motion, while another one is searched for
  MotionProblem problem;
  LevenbergMarquardt<6> solver;
  // Solves, then takes the step that the solver would try next without evaluating its cost.
  LmSummary solve(const LmOptions& options);
};

}  // namespace plvo
