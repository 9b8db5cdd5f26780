// SPDX-License-Identifier: Apache-2.0
// The propagated prior of other sensors as a constraint: a set of one match that has no landmark and does not
// take part in minimal sets. Its residual is r = T ⊟ T_propagated, translation before rotation; it adds ½
// ρ(rᵀ C⁻¹ r) to the cost (21). It is always an inlier, because a hypothesis is arbitrary in directions that
// vision does not determine. If it contradicts the images, Huber's loss bounds its influence.
#pragma once

#include "plvo/math/cholesky.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

class PriorConstraint final : public ConstraintSet {
 public:
  // covariance: of the ⊞-perturbation of T_propagated; if it has no Cholesky factor, the set is not usable.
  // flag: one byte that must outlive the set.
  PriorConstraint(const Se3& T_propagated, const Matrix6& covariance, std::span<std::uint8_t> flag);

  std::size_t size() const override { return 1; }
  int dof() const override { return 6; }
  bool usable(std::size_t) const override { return usable_; }
  Primitive primitive(std::size_t) const override { return {}; }
  Extent extent(std::size_t) const override { return {Vector3::UnitZ()}; }
  double mahalanobis_squared(std::size_t, const Se3&, double) const override { return 0; }
  void begin(const Se3&, const NuisanceParameters&, const RobustKernel&, std::size_t) override {}
  double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                   JointInformation& sum) const override;

 private:
  Se3 T_propagated_;
  Matrix6 information_ = Matrix6::Zero();
  bool usable_ = false;
};

}  // namespace plvo
