// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/depth_shift.hpp"

#include "plvo/math/mahalanobis.hpp"

namespace plvo {

// Not inlined: its matrices are no longer on the stack when the motion is solved for.
[[gnu::noinline]] DepthShift depth_shift(const PointConstraints& points, const Se3& T,
                                         double smooth_error_m) {
  Matrix3 H = Matrix3::Zero();
  Vector3 g = Vector3::Zero();
  const Vector3 axis = T.R.row(2).transpose();
  double depth = 0;
  int n = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.inliers()[i] == 0) continue;
    const Point3d& reference = points.reference_point(i);
    const Point3d& current = points.current_point(i);
    const Vector3 p = T * reference.p;
    const double variance = current.Sigma(2, 2) + axis.dot(reference.Sigma * axis);
    const double J[] = {1, p.y(), -p.x()};
    for (int a = 0; a < 3; ++a) {
      const double weighted = J[a] / variance;
      for (int b = 0; b < 3; ++b) H(a, b) += weighted * J[b];
      g[a] += weighted * (current.p.z() - p.z());
    }
    depth += p.z();
    ++n;
  }
  Cholesky<3> cholesky;
  if (!cholesky.factor(H)) return {};
  const Vector3 shift = cholesky.solve(g);
  // The residuals correlate (CostTerm::set_reference), so the covariance of the shift is C / share. The
  // smooth error's terms 1, x and y times depth² move and tilt a wall at the mean depth.
  const double share = points.share_of(n);
  const double tilt = smooth_error_m * depth / n;
  const double smooth[] = {tilt * depth / n, tilt, tilt};
  Matrix3 C = cholesky.inverse();
  for (int a = 0; a < 3; ++a) C(a, a) += share * smooth[a] * smooth[a];
  const double variance = 1 / H(0, 0) + share * smooth[0] * smooth[0];
  return {T.t.z(), g[0] / H(0, 0), share / variance, share * mahalanobis_squared<3>(shift, C)};
}

}  // namespace plvo
