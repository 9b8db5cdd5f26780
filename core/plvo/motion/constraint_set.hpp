// SPDX-License-Identifier: Apache-2.0
// The interface through which RANSAC and the refinement access features. Each kind of constraint (points,
// lines, …) is a ConstraintSet: a list of putative matches between two frames with their residuals,
// Jacobians, covariances, landmark blocks and minimal-set primitives. A new kind of constraint needs only one
// more implementation.
//
// T = T_current_reference maps reference coordinates to current coordinates, X' = R X + t, equation (11). Its
// perturbation ξ = (v, ω) is the ⊞ of se3.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "plvo/math/se3.hpp"
#include "plvo/motion/nuisance_parameters.hpp"
#include "plvo/motion/robust_kernel.hpp"

namespace plvo {

// Largest variance of a point or of a line's end. A more uncertain one is uninformative and would pass any χ²
// test.
inline constexpr double kMaxVarianceM2 = 1.0;

// The contribution of one match to a minimal set: a pair of points or a pair of lines. A line is a point on
// it and a unit direction of unknown sign. The sigmas serve only to reject degenerate or inconsistent sets.
struct Primitive {
  enum class Shape : std::uint8_t { kNone, kPoint, kLine };  // kNone: takes no part in minimal sets
  Shape shape = Shape::kNone;
  Vector3 p_reference, p_current;
  Vector3 d_reference, d_current;
  double sigma_p_m = 0;    // approximate SD of p_reference − p_current along any one direction
  double sigma_d_rad = 0;  // approximate SD of the angle between the directions
};

// Information H = Σ w Jᵀ Σ⁻¹ J and gradient g = Σ w Jᵀ Σ⁻¹ r of the motion's perturbation ξ and the nuisance
// parameters β, where J is the derivative with respect to (ξ, β).
struct JointInformation {
  static constexpr int kSize = 6 + NuisanceParameters::kCount;
  Matrix<kSize, kSize> H = Matrix<kSize, kSize>::Zero();
  Vector<kSize> g = Vector<kSize>::Zero();
  void set_zero() {
    std::memset(H.data(), 0, sizeof H);  // all bits zero is 0.0
    std::memset(g.data(), 0, sizeof g);
  }
};

// The part of the scene that a match stands for: its place in current coordinates, and the length of its
// image in the plane z = 1 (0 for a point).
struct Extent {
  Vector3 middle;
  double length = 0;
};

class ConstraintSet {
 public:
  virtual std::size_t size() const = 0;
  // Degrees of freedom of one match's residual: the dimension of its χ² distribution.
  virtual int dof() const = 0;
  // False for an uninformative match (not finite, covariance not positive definite or too large, …). Such a
  // match is never sampled and never an inlier.
  virtual bool usable(std::size_t i) const = 0;
  virtual Primitive primitive(std::size_t i) const = 0;
  virtual Extent extent(std::size_t i) const = 0;

  // Squared Mahalanobis distance between the two measurements of match i under T, χ²(dof()) for a true match.
  // If the distance exceeds `cutoff`, any value above `cutoff` may be returned.
  virtual double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const = 0;

  // Refinement. begin() prepares for motions near T. It evaluates at T what a set holds constant over one
  // solve (weights, landmark positions), and clears the flag of an inlier that cannot be weighted there.
  // every: stride over the matches. A set that RANSAC does not judge selects its inliers itself in begin(),
  // and may do so on every `every`-th match only. linearize() moves the remaining landmark parameters to
  // their optimum for T and for the value of the nuisance parameters, adds the Schur complement on (ξ, β) of
  // the inliers to `sum` (the β part only if there are nuisance parameters), and returns ½ Σ ρ. Its time is
  // linear in size().
  virtual void begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                     std::size_t every) = 0;
  virtual double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                           JointInformation& sum) const = 0;

  // reference: index of the reference that the matches are with (motion_problem.hpp); default 0. correlation:
  // between the residuals of any two matches. Errors that the features of a scene share do not average out,
  // so n matches weigh as much as n / (1 + (n − 1) correlation) independent ones. weight: an additional
  // factor for each match, below 1 where another set uses the same measurements.
  void set_reference(std::size_t reference, double correlation, double weight = 1) {
    reference_ = reference;
    correlation_ = correlation;
    weight_ = weight;
  }
  std::size_t reference() const { return reference_; }
  double correlation() const { return correlation_; }
  double weight() const { return weight_; }

  // One flag per match. RANSAC writes them; the refinement and the caller read them.
  std::span<std::uint8_t> inliers() { return inliers_; }
  std::span<const std::uint8_t> inliers() const { return inliers_; }

 protected:
  explicit ConstraintSet(std::span<std::uint8_t> inliers) : inliers_(inliers) {}
  ConstraintSet(const ConstraintSet&) = default;
  ConstraintSet& operator=(const ConstraintSet&) = default;
  ~ConstraintSet() = default;  // never deleted through a base pointer

  std::span<std::uint8_t> inliers_;

 private:
  std::size_t reference_ = 0;
  double correlation_ = 0;
  double weight_ = 1;
};

}  // namespace plvo
