// SPDX-License-Identifier: Apache-2.0
// Conditions on a covariance, and their repair after rounding or a long gap. Sums of the form J C Jᵀ preserve
// the conditions up to rounding. Rounding matters where a large variance is almost cancelled: by a much more
// certain measurement, or by a lever arm that is reversed.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// The bound on the uncertainty of a pose. No rotation error exceeds π, so the mean square of each of its
// components is at most π². A position with an uncertainty of a kilometre is useless for images that show a
// few metres; a prior may have the same uncertainty (MotionPrior::validate).
inline constexpr double kMostRotationVariance = 9.869604401089358;  // rad²
inline constexpr double kMostPositionVariance = 1e6;                // m²

// Tolerance of the conditions, relative to the standard deviations, i.e. of correlations.
inline constexpr double kCovarianceTolerance = 1e-9;

// Whether the position may be farther away than the bound; C: of (position, orientation).
inline bool may_be_anywhere(const Matrix6& C) {
  return !(C.diagonal().head<3>().maxCoeff() <= kMostPositionVariance);
}

// Bounds on the variances of a position and of an orientation, each the sum over three directions.
struct VarianceBounds {
  double position_m2 = 0;
  double orientation_rad2 = 0;
};

// Whether a variance of C, of (position, orientation), is above its bound, or is not a number.
inline bool exceeds(const Matrix6& C, const VarianceBounds& bounds) {
  return !(C.diagonal().head<3>().sum() <= bounds.position_m2 &&
           C.diagonal().tail<3>().sum() <= bounds.orientation_rad2);
}

// The generalised variance det C (Wilks 1932): the squared volume of the ellipsoid of C, up to a factor. It
// compares two covariances of one motion without weighing metres against radians, and it is the same about
// every point. Zero for no uncertainty at all; infinite where C is not positive definite otherwise.
double generalised_variance(const Matrix6& C);

// Whether C is finite, without negative variances, symmetric to the tolerance, and with no eigenvalue of the
// correlation matrix below minus the tolerance.
bool is_covariance(const Matrix3& C);
bool is_covariance(const Matrix6& C);

// Makes C a covariance; a valid one stays the same bit by bit. Otherwise C is made symmetric, rows and
// columns without a positive variance become zero, and the correlations become the nearest semidefinite
// matrix (their negative eigenvalues are set to zero). Returns false where C is not finite.
bool make_covariance(Matrix6& C);

// Does the same for (position, orientation), and bounds the variances. A row and a column with a variance
// beyond its bound are scaled, which keeps the correlations. scale: these factors, all ones if no variance
// was too large.
bool make_bounded_covariance(Matrix6& C, Vector6* scale = nullptr);

}  // namespace plvo
