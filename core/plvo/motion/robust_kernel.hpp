// SPDX-License-Identifier: Apache-2.0
// What a large residual is worth. The refinement minimises ½ Σ ρ(s), s the squared Mahalanobis norm of one
// match's residual; iteratively re-weighted with w = ρ'(s), and the covariance uses the same weights: C = (Σ
// w Jᵀ Σ⁻¹ J)⁻¹.
#pragma once

#include <cstdint>

#include "plvo/math/chi_square.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

enum class RobustLoss : std::uint8_t {
  // ρ(s) = s: the paper's maximum likelihood for Gaussian noise.
  kNone,
  // ρ(s) = s up to k², 2 k √s − k² beyond. k² is the 95 % quantile of χ²(dof), so that 19 of 20 good matches
  // keep weight 1 whatever their kind: C stays honest under Gaussian noise, and the problem stays convex
  // where it was.
  kHuber,
};

class RobustKernel {
 public:
  RobustKernel() = default;
  RobustKernel(RobustLoss loss, int dof)
      : loss_(loss), k_squared_(loss == RobustLoss::kHuber ? chi_square_quantile(dof, 0.95) : 0) {}

  // ρ(s) and, in weight, ρ'(s).
  double operator()(double s, double& weight) const {
    if (loss_ == RobustLoss::kHuber && s > k_squared_) {
      const double ks = sqrt(k_squared_ * s);
      weight = ks / s;
      return 2 * ks - k_squared_;
    }
    weight = 1;
    return s;
  }

 private:
  RobustLoss loss_ = RobustLoss::kNone;
  double k_squared_ = 0;
};

}  // namespace plvo
