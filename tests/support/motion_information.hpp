// SPDX-License-Identifier: Apache-2.0
// The information of a set of matches on the motion, for tests of Theorem 1.
#pragma once

#include "plvo/motion/constraint_set.hpp"

namespace plvo::test {

// 6×6, of the inliers alone, with the weights that the last estimate left.
inline Matrix6 information_of(const ConstraintSet& set, const Se3& T) {
  JointInformation sum;
  (void)set.linearize(T, {}, RobustKernel(RobustLoss::kHuber, set.dof()), sum);
  return sum.H.block<6, 6>(0, 0);
}

}  // namespace plvo::test
