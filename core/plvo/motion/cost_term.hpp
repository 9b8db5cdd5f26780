// SPDX-License-Identifier: Apache-2.0
// A term of the cost that the joint estimate minimises: the matches of one kind of feature with one
// reference, the surface samples of a reference, or the propagated prior.
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

// The landmarks that a term measures; a prior measures none.
enum class LandmarkKind : std::uint8_t { kPoints, kLines, kSurfaces, kNone };
inline constexpr int kLandmarkKinds = 3;
// A column for each kind but kNone.
using OfEachKind = Matrix<6, kLandmarkKinds>;

// Where some measurements are to decide, they weigh this many times as much as the others, which then decide
// only the directions that the first leave open.
inline constexpr double kFavoured = 1024;

class CostTerm {
 public:
  virtual LandmarkKind kind() const = 0;
  // Degrees of freedom of one residual: the dimension of its χ² distribution.
  virtual int dof() const = 0;
  // begin() prepares for motions near T. It evaluates at T what a term holds constant over one solve
  // (weights, landmark positions), and clears the flag of an inlier that cannot be weighted there. every:
  // stride over the residuals. A term that RANSAC does not judge selects its inliers itself in begin(), and
  // may do so on every `every`-th residual only.
  virtual void begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                     std::size_t every) = 0;
  // Moves the remaining landmark parameters to their optimum for T and for the value of the nuisance
  // parameters, adds the Schur complement on (ξ, β) of the inliers to `sum` (the β part only if there are
  // nuisance parameters), and returns ½ Σ ρ. Its time is linear in the number of residuals.
  virtual double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                           JointInformation& sum) const = 0;
  // Whether the term alone determines all six degrees of freedom.
  virtual bool fixes_motion() const { return false; }
  // Whether the term excludes the motion, whatever the others say.
  virtual bool contradicts(const Se3&) const { return false; }

  // reference: index of the reference to which the residuals belong (motion_problem.hpp); default 0.
  // correlation: between any two residuals. Errors that the features of a scene share do not average out, so
  // n residuals weigh as much as n / (1 + (n − 1) correlation) independent ones. weight: an additional factor
  // for each, below 1 where another term uses the same measurements.
  void set_reference(std::size_t reference, double correlation, double weight = 1) {
    reference_ = reference;
    correlation_ = correlation;
    weight_ = weight;
  }
  void scale_weight(double factor) { weight_ *= factor; }
  // Weight of n residuals relative to n independent ones, without the additional factor.
  double share_of(int n) const { return n > 1 ? 1 / (1 + (n - 1) * correlation_) : 1; }
  std::size_t reference() const { return reference_; }
  double weight() const { return weight_; }

  // One flag per match or sample; empty for a term without matches and samples. RANSAC or begin() writes
  // them; the refinement and the caller read them.
  std::span<std::uint8_t> inliers() { return inliers_; }
  std::span<const std::uint8_t> inliers() const { return inliers_; }

 protected:
  explicit CostTerm(std::span<std::uint8_t> inliers) : inliers_(inliers) {}
  CostTerm(const CostTerm&) = default;
  CostTerm& operator=(const CostTerm&) = default;
  ~CostTerm() = default;  // never deleted through a base pointer

  std::span<std::uint8_t> inliers_;

 private:
  std::size_t reference_ = 0;
  double correlation_ = 0;
  double weight_ = 1;
};

}  // namespace plvo
