// SPDX-License-Identifier: Apache-2.0
// The propagated prior of other sensors as a term of the cost. Its residual is r = T ⊟ T_propagated,
// translation before rotation; it adds ½ ρ(rᵀ C⁻¹ r) to the cost (21). RANSAC does not judge it, because a
// hypothesis is arbitrary in directions that vision does not determine. If the prior contradicts the images,
// Huber's loss bounds its influence. If the images show two motions and it contradicts one of them, the other
// is taken as the camera's. The same term holds a kind of landmark that decides alone near the common motion
// (ConsensusSolver in motion_estimator.cpp).
#pragma once

#include "plvo/math/cholesky.hpp"
#include "plvo/motion/cost_term.hpp"

namespace plvo {

class PriorConstraint final : public CostTerm {
 public:
  // covariance: of the ⊞-perturbation of T_propagated; without a Cholesky factor the term is zero.
  PriorConstraint(const Se3& T_propagated, const Matrix6& covariance);

  LandmarkKind kind() const override { return LandmarkKind::kNone; }
  int dof() const override { return 6; }
  bool fixes_motion() const override { return usable_; }
  // Whether rᵀ C⁻¹ r exceeds what the noise of both explains.
  bool contradicts(const Se3& T) const override;
  void begin(const Se3&, const NuisanceParameters&, const RobustKernel&, std::size_t) override {}
  double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                   JointInformation& sum) const override;

 private:
  Se3 T_propagated_;
  Matrix6 information_ = Matrix6::Zero();
  bool usable_ = false;
};

}  // namespace plvo
