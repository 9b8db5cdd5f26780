// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_problem.hpp"

namespace plvo {

MotionProblem::Kernels MotionProblem::make_kernels(std::span<ConstraintSet* const> sets, RobustLoss loss) {
  Kernels kernels;
  for (std::size_t kind = 0; kind < sets.size() && kind < kMaxConstraintKinds; ++kind)
    kernels[kind] = RobustKernel(loss, sets[kind]->dof());
  return kernels;
}

MotionProblem::MotionProblem(std::span<ConstraintSet* const> sets, const Kernels& kernels, const Se3& T)
    : sets_(sets.first(sets.size() < kMaxConstraintKinds ? sets.size() : kMaxConstraintKinds)),
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
  double cost = 0;
  for (std::size_t kind = 0; kind < sets_.size(); ++kind) {
    Matrix6& information = candidate_information_[kind];
    information.setZero();
    cost += sets_[kind]->linearize(candidate_, kernels_[kind], information, g);
    H += information;
  }
  return cost;
}

void MotionProblem::accept() {
  T_ = {renormalise(candidate_.R), candidate_.t};
  information_ = candidate_information_;
  for (ConstraintSet* set : sets_) set->accept();
}

}  // namespace plvo
