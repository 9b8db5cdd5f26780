// SPDX-License-Identifier: Apache-2.0
// Computes a motion from three matches (section 5.1 of the paper): 3 points; 3 lines; 1 point + 2 lines; 2
// points + 1 line. Sets that do not determine the motion, or that no rigid motion explains, are rejected
// before the solve.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/math/se3.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

enum class MinimalSetStatus : std::uint8_t {
  kSolved,
  kDegenerate,    // nearly collinear, nearly parallel, or a point nearly on the line, relative to their
                  // uncertainty
  kInconsistent,  // a distance or angle between two of the three differs between the frames by more than 4
                  // SDs
};

// set: points and lines in any order. T = T_current_reference is written for kSolved only. Three mutually
// perpendicular lines allow several rotations, because a direction has no sign and rotations by 180° about
// the axes fit equally well. The rotation nearest to R_expected is returned.
MinimalSetStatus solve_minimal_set(const std::array<Primitive, 3>& set, const Matrix3& R_expected, Se3& T);

}  // namespace plvo
