// SPDX-License-Identifier: Apache-2.0
// Robust loss of the refinement. It minimises ½ Σ ρ(s), where s is the squared Mahalanobis norm of one
// match's residual, by iterative re-weighting with w = ρ'(s). The covariance uses the same weights: C = (Σ w
// Jᵀ Σ⁻¹ J)⁻¹.
#pragma once

#include <cstdint>

#include "plvo/math/chi_square.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

enum class RobustLoss : std::uint8_t {
  // ρ(s) = s: the paper's maximum likelihood for Gaussian noise.
  kNone,
  // ρ(s) = s up to k², 2 k √s − k² beyond. k² is the 95 % quantile of χ²(dof), so 19 of 20 good matches of
  // any kind keep weight 1. C stays consistent under Gaussian noise, and the loss preserves convexity.
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
