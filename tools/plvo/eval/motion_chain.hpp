// SPDX-License-Identifier: Apache-2.0
// Chains motions from frame to reference into the motion between any two frames. A frame has one motion, so
// that the frames of an unbroken sequence form a tree; the path between two of them leads through their
// newest common ancestor. Covariances are composed to first order and assume independent errors: the
// correlation of neighbouring motions is not part of them and shows in the NEES.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

class MotionChain {
 public:
  // Of several motions with the same stamp the first one is used; a motion whose reference is not older is
  // ignored.
  explicit MotionChain(const std::vector<UncertainMotion>& motions);

  // Every frame that a motion starts from or leads to, in increasing order.
  const std::vector<std::int64_t>& stamps_ns() const { return stamps_ns_; }

  // Computes the motion from frame `from` to frame `to` (indices of stamps_ns()): T_to_from with its
  // covariance. Returns false if the chain between them is broken.
  bool between(std::size_t from, std::size_t to, Se3& T_to_from, Matrix6& covariance) const;

 private:
  struct Climb;
  bool step(Climb& climb) const;

  const std::vector<UncertainMotion>& motions_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::ptrdiff_t> motion_of_;  // by frame; −1: none
  std::vector<std::size_t> parent_;        // reference frame of each frame
};

}  // namespace plvo::eval
