// SPDX-License-Identifier: Apache-2.0
// What a covariance must be, and how one that rounding or a long gap has spoilt becomes one again. Sums of
// the form J C Jᵀ keep a covariance what it is up to rounding. Rounding matters where a large variance is
// almost cancelled: by a measurement that is far surer, or by a lever arm that is taken back.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// The one bound of what a pose may be unsure of. No rotation is off by more than π: the mean square of each
// component of its error is at most π². A position that is unsure by a kilometre says nothing that anybody
// could use of images that show a few metres; so far a prior may reach, too (MotionPrior::validate).
inline constexpr double kMostRotationVariance = 9.869604401089358;  // rad²
inline constexpr double kMostPositionVariance = 1e6;                // m²

// How exactly: relative to the standard deviations, i.e. of correlations.
inline constexpr double kCovarianceTolerance = 1e-9;

// Of (position, orientation): the position may be farther away than the bound.
inline bool may_be_anywhere(const Matrix6& C) {
  return !(C.diagonal().head<3>().maxCoeff() <= kMostPositionVariance);
}

// Finite, no negative variance, symmetric to the tolerance, no correlation matrix's eigenvalue below minus
// the tolerance.
bool is_covariance(const Matrix6& C);

// Unchanged, bit by bit, where it is a covariance. Otherwise it is made symmetric, what has no positive
// variance becomes zero, and its correlations become the nearest semidefinite matrix (their negative
// eigenvalues are set to zero). False where it is not finite.
bool make_covariance(Matrix6& C);

// The same of (position, orientation), and no variance is beyond its bound: a row and a column whose variance
// is are scaled, which keeps the correlations. scale: these factors, all ones where nothing was too large.
bool make_bounded_covariance(Matrix6& C, Vector6* scale = nullptr);

}  // namespace plvo
