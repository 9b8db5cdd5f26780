// SPDX-License-Identifier: Apache-2.0
// A term of the cost whose matches RANSAC draws from and judges: the points, or the lines, that one reference
// has in common with the current frame. The refinement minimises the cost of the matches that agree.
//
// T = T_current_reference maps reference coordinates to current coordinates, X' = R X + t, equation (11). Its
// perturbation ξ = (v, ω) is the ⊞ of se3.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/math/se3.hpp"
#include "plvo/motion/cost_term.hpp"
#include "plvo/motion/coverage.hpp"

namespace plvo {

// Largest variance of a point or of a line's end. A more uncertain one is uninformative and would pass any χ²
// test.
inline constexpr double kMaxVarianceM2 = 1.0;

// The contribution of one match to a minimal set: a pair of points or a pair of lines. A line is a point on
// it and a unit direction of unknown sign. The sigmas serve only to reject degenerate or inconsistent sets.
struct Primitive {
  enum class Shape : std::uint8_t { kPoint, kLine };
  Shape shape = Shape::kPoint;
  Vector3 p_reference, p_current;
  Vector3 d_reference, d_current;
  double sigma_p_m = 0;    // approximate SD of p_reference − p_current along any one direction
  double sigma_d_rad = 0;  // approximate SD of the angle between the directions
};

class ConstraintSet : public CostTerm {
 public:
  virtual std::size_t size() const = 0;
  // False for an uninformative match (not finite, covariance not positive definite or too large, …). Such a
  // match is never sampled and never an inlier.
  virtual bool usable(std::size_t i) const = 0;
  virtual Primitive primitive(std::size_t i) const = 0;
  // In current coordinates, with the record of the reference's landmark.
  virtual Extent extent(std::size_t i) const = 0;

  // Squared Mahalanobis distance between the two measurements of match i under T, χ²(dof()) for a true match.
  // If the distance exceeds `cutoff`, any value above `cutoff` may be returned.
  virtual double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const = 0;

 protected:
  explicit ConstraintSet(std::span<std::uint8_t> inliers) : CostTerm(inliers) {}
  ConstraintSet(const ConstraintSet&) = default;
  ConstraintSet& operator=(const ConstraintSet&) = default;
  ~ConstraintSet() = default;  // never deleted through a base pointer
};

}  // namespace plvo
