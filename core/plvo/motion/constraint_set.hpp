// SPDX-License-Identifier: Apache-2.0
// All that RANSAC and the refinement know of a feature. A kind of constraint (points, lines, …) is a
// ConstraintSet: a list of putative matches between two frames that brings its residual, its Jacobian, its
// covariance, its landmark block and its part in a minimal set. A further kind is one more implementation;
// nothing else changes.
//
// T = T_current_reference maps reference coordinates to current ones, X' = R X + t, equation (11). Its
// perturbation is the ⊞ of se3.hpp, ξ = (v, ω).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "plvo/math/se3.hpp"
#include "plvo/motion/nuisance_parameters.hpp"
#include "plvo/motion/robust_kernel.hpp"

namespace plvo {

// A point, or an end of a line, more uncertain than this tells nothing, and would pass any χ² test.
inline constexpr double kMaxVarianceM2 = 1.0;

// What one match offers to a minimal set: a pair of points, or of lines (a point on it, and its direction,
// unit length, sign unknown). The sigmas only serve to reject degenerate or inconsistent sets.
struct Primitive {
  enum class Shape : std::uint8_t { kNone, kPoint, kLine };  // kNone: takes no part in minimal sets
  Shape shape = Shape::kNone;
  Vector3 p_reference, p_current;
  Vector3 d_reference, d_current;
  double sigma_p_m = 0;    // SD of p_reference − p_current in any one direction, about
  double sigma_d_rad = 0;  // SD of the angle between the directions, about
};

// Information and gradient of the motion's perturbation ξ and of the shared errors β: Σ w Jᵀ Σ⁻¹ J and Σ w Jᵀ
// Σ⁻¹ r with J the derivative by (ξ, β).
struct JointInformation {
  static constexpr int kSize = 6 + NuisanceParameters::kCount;
  Matrix<kSize, kSize> H = Matrix<kSize, kSize>::Zero();
  Vector<kSize> g = Vector<kSize>::Zero();
  void set_zero() {
    std::memset(H.data(), 0, sizeof H);  // zero, in bits
    std::memset(g.data(), 0, sizeof g);
  }
};

class ConstraintSet {
 public:
  virtual std::size_t size() const = 0;
  // Degrees of freedom of one match's residual: the dimension of its χ² distribution.
  virtual int dof() const = 0;
  // False for a match that can say nothing (not finite, covariance not positive definite or absurdly large,
  // …): it is never sampled, never an inlier.
  virtual bool usable(std::size_t i) const = 0;
  virtual Primitive primitive(std::size_t i) const = 0;

  // Squared Mahalanobis distance between the two measurements of match i under T, χ²(dof()) for a true match.
  // Any value above `cutoff` may be returned as soon as it is known to be above.
  virtual double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const = 0;

  // Refinement. begin() prepares for motions about T: what a set holds constant over one solve (weights,
  // places of landmarks) it takes there; an inlier that cannot be weighed there is none any more. every: what
  // RANSAC does not judge, and so the set judges itself, need only look at each so many-th match.
  // linearize() moves the other parts of the landmarks to their optimum for T and the shared errors' value,
  // adds their Schur complement on (ξ, β) to `sum` (over the inliers; what belongs to β only if there are
  // any) and returns ½ Σ ρ there. Time is linear in size().
  virtual void begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                     std::size_t every) = 0;
  virtual double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                           JointInformation& sum) const = 0;

  // reference: which of them the matches are with (motion_problem.hpp), 0 unless said otherwise. correlation:
  // between the residuals of any two matches; errors that the features of a scene share do not average out,
  // so n matches weigh as n / (1 + (n − 1) correlation) independent ones. weight: of each match besides, less
  // than 1 where another set judges the same measurements.
  void set_reference(std::size_t reference, double correlation, double weight = 1) {
    reference_ = reference;
    correlation_ = correlation;
    weight_ = weight;
  }
  std::size_t reference() const { return reference_; }
  double correlation() const { return correlation_; }
  double weight() const { return weight_; }

  // One flag per match, written by RANSAC, read by the refinement and by the caller.
  std::span<std::uint8_t> inliers() { return inliers_; }
  std::span<const std::uint8_t> inliers() const { return inliers_; }

 protected:
  explicit ConstraintSet(std::span<std::uint8_t> inliers) : inliers_(inliers) {}
  ConstraintSet(const ConstraintSet&) = default;
  ConstraintSet& operator=(const ConstraintSet&) = default;
  ~ConstraintSet() = default;  // never deleted through the base

  std::span<std::uint8_t> inliers_;

 private:
  std::size_t reference_ = 0;
  double correlation_ = 0;
  double weight_ = 1;
};

}  // namespace plvo
