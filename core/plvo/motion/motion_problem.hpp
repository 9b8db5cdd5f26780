// SPDX-License-Identifier: Apache-2.0
// The joint maximum-likelihood problem (21)–(23) in the form the Levenberg–Marquardt solver wants: six
// parameters, every kind of constraint eliminates its own landmarks. H is C_P⁻¹ + C_L⁻¹ + …, equation (26),
// kept by kind.
#pragma once

#include <array>
#include <span>

#include "plvo/math/levenberg_marquardt.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

inline constexpr std::size_t kMaxConstraintKinds = 4;

class MotionProblem {
 public:
  using Kernels = std::array<RobustKernel, kMaxConstraintKinds>;
  // One kernel per set; made once, for the quantile in it takes longer than a residual.
  static Kernels make_kernels(std::span<ConstraintSet* const> sets, RobustLoss loss);

  // Over the inliers flagged in each set (at most kMaxConstraintKinds sets), starting at T.
  MotionProblem(std::span<ConstraintSet* const> sets, const Kernels& kernels, const Se3& T);

  double linearize(const Vector6& step, Matrix6& H, Vector6& g);
  void accept();

  const Se3& T_current_reference() const { return T_; }
  // The Schur complement of one kind at the accepted state: C_P⁻¹ (14), C_L⁻¹ (19).
  const Matrix6& information(std::size_t kind) const { return information_[kind]; }

 private:
  std::span<ConstraintSet* const> sets_;
  Kernels kernels_;
  Se3 T_, candidate_;
  std::array<Matrix6, kMaxConstraintKinds> information_, candidate_information_;
};

}  // namespace plvo
