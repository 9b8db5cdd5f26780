// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/prior_constraint.hpp"

namespace plvo {
namespace {

// Squared Mahalanobis distance beyond which the prior contradicts a motion. It is far above a quantile of χ²,
// because the estimate has an error too, and a prior is seldom as good as its covariance: in three simulated
// rooms at rest the distance stayed below 29, with a gyro.
constexpr double kContradiction = 50;

}  // namespace

PriorConstraint::PriorConstraint(const Se3& T_propagated, const Matrix6& covariance)
    : CostTerm({}), T_propagated_(T_propagated) {
  Cholesky<6> cholesky;
  usable_ = T_propagated.is_finite() && covariance.allFinite() && cholesky.factor(covariance);
  if (usable_) information_ = cholesky.inverse();
}

bool PriorConstraint::contradicts(const Se3& T) const {
  if (!usable_) return false;
  const Vector6 r = boxminus(T, T_propagated_);
  return r.dot(Vector6(information_.lazyProduct(r))) > kContradiction;
}

double PriorConstraint::linearize(const Se3& T, const NuisanceParameters&, const RobustKernel& kernel,
                                  JointInformation& sum) const {
  if (!usable_) return 0;
  const Vector6 r = boxminus(T, T_propagated_);
  // ∂ log(Exp(ω) Exp(φ)) / ∂ω at 0, to the fourth order in φ.
  const Matrix3 Phi = skew(r.tail<3>());
  Matrix6 J = Matrix6::Identity();
  J.block<3, 3>(3, 3) += -0.5 * Phi + (1.0 / 12) * Phi.lazyProduct(Phi);
  const Vector6 weighted = information_.lazyProduct(r);
  double weight = 1;
  const double cost = 0.5 * kernel(r.dot(weighted), weight);
  const Matrix6 information_J = information_.lazyProduct(J);
  sum.H.block<6, 6>(0, 0) += weight * Matrix6(J.transpose().lazyProduct(information_J));
  sum.g.head<6>() += weight * Vector6(J.transpose().lazyProduct(weighted));
  return cost;
}

}  // namespace plvo
