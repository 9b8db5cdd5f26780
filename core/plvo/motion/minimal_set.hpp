// SPDX-License-Identifier: Apache-2.0
// A motion from three matches, section 5.1 of the paper: 3 points; 3 lines; 1 point + 2 lines; 2 points + 1
// line. Sets that cannot fix the motion, or that no rigid motion can explain, are thrown away before anything
// is solved.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/math/se3.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

enum class MinimalSetStatus : std::uint8_t {
  kSolved,
  kDegenerate,    // nearly collinear, nearly parallel, or a point nearly on the line, measured by their own
                  // uncertainty
  kInconsistent,  // distances or angles between the three differ between the frames by more than 4 SDs
};

// set: points and lines in any order. T is written for kSolved only. Three lines that are mutually
// perpendicular allow several rotations (a direction has no sign, and 180° turns about the axes fit alike):
// the one nearest to R_expected is taken.
MinimalSetStatus solve_minimal_set(const std::array<Primitive, 3>& set, const Matrix3& R_expected, Se3& T);

}  // namespace plvo
