// SPDX-License-Identifier: Apache-2.0
// Motions from frame to reference, chained into the motion between any two frames. A frame has one motion, so
// that the frames of an unbroken stretch form a tree; two of them are connected through the newest frame that
// both descend from. Covariances are composed to first order as those of independent errors: what
// neighbouring motions have in common is not in their covariances, and shows in the NEES.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

class MotionChain {
 public:
  // Of motions with one stamp the first one counts; a motion whose reference is not older than itself does
  // not.
  explicit MotionChain(const std::vector<UncertainMotion>& motions);

  // Every frame that a motion starts from or leads to, in increasing order.
  const std::vector<std::int64_t>& stamps_ns() const { return stamps_ns_; }

  // The motion from frame `from` to frame `to` (indices of stamps_ns()): T_to_from with its covariance. False
  // where the chain is broken in between.
  bool between(std::size_t from, std::size_t to, Se3& T_to_from, Matrix6& covariance) const;

 private:
  struct Climb;
  bool step(Climb& climb) const;

  const std::vector<UncertainMotion>& motions_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::ptrdiff_t> motion_of_;  // of each frame, −1: none
  std::vector<std::size_t> parent_;        // its reference
};

}  // namespace plvo::eval
