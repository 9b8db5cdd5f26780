// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_problem.hpp"

#include "plvo/math/cholesky.hpp"

namespace plvo {

MotionProblem::Kernels MotionProblem::make_kernels(std::span<ConstraintSet* const> sets, RobustLoss loss) {
  Kernels kernels;
  for (std::size_t kind = 0; kind < sets.size() && kind < kMaxConstraintKinds; ++kind)
    kernels[kind] = RobustKernel(loss, sets[kind]->dof());
  return kernels;
}

MotionsToCurrent motions_to_current(const Se3& T_current_base, const MotionReferences& references) {
  MotionsToCurrent motions;
  motions[0] = T_current_base;
  for (std::size_t r = 1; r < kMaxReferences; ++r)
    motions[r] = T_current_base * references[r].T_reference_base.inverse();
  return motions;
}

namespace {

int count_inliers(const ConstraintSet& set) {
  int n = 0;
  for (const std::uint8_t flag : set.inliers()) n += flag;
  return n;
}

// H ← (H⁻¹ + S)⁻¹ with S = L Lᵀ, the gradient and the cost with it: what is left when a motion of covariance
// S between the two frames is minimised over.
double convolve(const Matrix6& L, Matrix6& H, Vector6& g) {
  const Matrix6 HL = H * L;
  const Matrix6 M = Matrix6::Identity() + L.transpose() * HL;
  Cholesky<6> cholesky;
  if (!cholesky.factor(M)) return 0;
  const Vector6 Lg = L.transpose() * g;
  const Vector6 x = cholesky.solve(Lg);
  H -= HL * (cholesky.inverse() * HL.transpose());
  H = 0.5 * (H + Matrix6(H.transpose()));
  g -= HL * x;
  return -0.5 * Lg.dot(x);
}

// Lower Cholesky factor with zero columns where there is nothing.
Matrix6 root(const Matrix6& S) {
  Matrix6 L = Matrix6::Zero();
  for (int j = 0; j < 6; ++j) {
    double d = S(j, j);
    for (int k = 0; k < j; ++k) d -= L(j, k) * L(j, k);
    if (!(d > 1e-20)) continue;
    L(j, j) = sqrt(d);
    for (int i = j + 1; i < 6; ++i) {
      double s = S(i, j);
      for (int k = 0; k < j; ++k) s -= L(i, k) * L(j, k);
      L(i, j) = s / L(j, j);
    }
  }
  return L;
}

}  // namespace

MotionProblem::MotionProblem(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                             const Kernels& kernels, const Se3& T, bool marginalise)
    : sets_(sets.first(sets.size() < kMaxConstraintKinds ? sets.size() : kMaxConstraintKinds)),
      references_(references),
      marginalise_(marginalise),
      kernels_(kernels),
      T_(T),
      candidate_(T) {
  for (Matrix6& information : information_) information.setZero();
  for (ConstraintSet* set : sets_) set->begin();
}

double MotionProblem::linearize(const Vector6& step, Matrix6& H, Vector6& g) {
  candidate_ = boxplus(T_, step);
  H.setZero();
  g.setZero();
  const MotionsToCurrent motions = motions_to_current(candidate_, references_);
  double cost = 0;
  for (std::size_t r = 0; r < kMaxReferences; ++r) {
    Matrix6 H_r = Matrix6::Zero();
    Vector6 g_r = Vector6::Zero();
    double cost_r = 0;
    bool any = false;
    for (std::size_t kind = 0; kind < sets_.size(); ++kind) {
      ConstraintSet& set = *sets_[kind];
      if (set.reference() != r) continue;
      any = true;
      Matrix6& information = candidate_information_[kind];
      information.setZero();
      Vector6 g_k = Vector6::Zero();
      const double cost_k = set.linearize(motions[r], kernels_[kind], information, g_k);
      const double share =
          1 / (1 + (count_inliers(set) > 1 ? count_inliers(set) - 1 : 0) * set.correlation());
      information *= share;
      H_r += information;
      g_r += share * g_k;
      cost_r += share * cost_k;
    }
    if (!any) continue;
    if (r == 0) {
      H += H_r;
      g += g_r;
      cost += cost_r;
      continue;
    }
    const Matrix3 Q = skew(motions[r].R * references_[r].T_reference_base.t);
    Matrix6 A = Matrix6::Identity();
    A.block<3, 3>(0, 3) = Q;
    if (marginalise_) {
      Matrix6 B = Matrix6::Zero();
      B.block<3, 3>(0, 0) = motions[r].R;
      B.block<3, 3>(0, 3) = Q * motions[r].R;
      B.block<3, 3>(3, 3) = motions[r].R;
      cost_r += convolve(root(B * references_[r].covariance * B.transpose()), H_r, g_r);
    }
    H += A.transpose() * H_r * A;
    g += A.transpose() * g_r;
    cost += cost_r;
  }
  return cost;
}

void MotionProblem::accept() {
  T_ = {renormalise(candidate_.R), candidate_.t};
  information_ = candidate_information_;
  for (ConstraintSet* set : sets_) set->accept();
}

}  // namespace plvo
