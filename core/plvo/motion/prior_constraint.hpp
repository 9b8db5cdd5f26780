// SPDX-License-Identifier: Apache-2.0
// A motion that other sensors tell, as one more kind of constraint: a set of one, without landmark, that no
// minimal set is drawn from. Its residual is r = T ⊟ T_propagated, translation before rotation; ½ ρ(rᵀ C⁻¹ r)
// joins the cost (21). It is always an inlier: in a direction that vision leaves open a hypothesis may lie
// anywhere. Where it contradicts what is seen, Huber's loss bounds its pull.
#pragma once

#include "plvo/math/cholesky.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

class PriorConstraint final : public ConstraintSet {
 public:
  // covariance: of the ⊞-perturbation of T_propagated; without a Cholesky factor the set is not usable. flag:
  // one byte that outlives the set.
  PriorConstraint(const Se3& T_propagated, const Matrix6& covariance, std::span<std::uint8_t> flag);

  std::size_t size() const override { return 1; }
  int dof() const override { return 6; }
  bool usable(std::size_t) const override { return usable_; }
  Primitive primitive(std::size_t) const override { return {}; }
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
