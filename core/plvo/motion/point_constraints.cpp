// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/point_constraints.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/pair.hpp"

namespace plvo {
namespace {

bool is_measurement(const Point3d& point) {
  Cholesky<3> cholesky;
  return point.p.allFinite() && point.Sigma.allFinite() && point.Sigma.trace() <= kMaxVarianceM2 &&
         cholesky.factor(point.Sigma);
}

// Six numbers of a symmetric 3×3 matrix.
struct Symmetric3 {
  double xx, xy, xz, yy, yz, zz;
  Vector3 operator*(const Vector3& v) const {
    return {xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
            xz * v.x() + yz * v.y() + zz * v.z()};
  }
};

// R Σ Rᵀ + Σ'.
Symmetric3 sum_of_covariances(const Matrix3& R, const Matrix3& Sigma, const Matrix3& Sigma_current) {
  const Matrix3 A = R.lazyProduct(Sigma);
  const auto entry = [&](int i, int j) {
    return A(i, 0) * R(j, 0) + A(i, 1) * R(j, 1) + A(i, 2) * R(j, 2) + Sigma_current(i, j);
  };
  return {entry(0, 0), entry(1, 0), entry(2, 0), entry(1, 1), entry(2, 1), entry(2, 2)};
}

// Inverse by cofactors. It needs one division, and covariances of measurements are far from singular.
inline Symmetric3 inverse(const Symmetric3& m) {
  const double xx = m.yy * m.zz - m.yz * m.yz;
  const double xy = m.xz * m.yz - m.xy * m.zz;
  const double xz = m.xy * m.yz - m.xz * m.yy;
  const double scale = 1 / (m.xx * xx + m.xy * xy + m.xz * xz);
  return {xx * scale,
          xy * scale,
          xz * scale,
          (m.xx * m.zz - m.xz * m.xz) * scale,
          (m.xy * m.xz - m.xx * m.yz) * scale,
          (m.xx * m.yy - m.xy * m.xy) * scale};
}

}  // namespace

PointConstraints::PointConstraints(std::span<const Point3d> reference, std::span<const Point3d> current,
                                   std::span<const Match> matches, const Workspace& workspace)
    : ConstraintSet(workspace.inliers.first(std::min(matches.size(), workspace.inliers.size()))),
      reference_(reference),
      current_(current),
      matches_(matches.first(inliers_.size())),
      usable_(workspace.usable.first(inliers_.size())) {
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    const Match& match = matches_[i];
    inliers_[i] = 0;
    usable_[i] = match.reference < reference_.size() && match.current < current_.size() &&
                 is_measurement(reference_[match.reference]) && is_measurement(current_[match.current]);
  }
}

Primitive PointConstraints::primitive(std::size_t i) const {
  Primitive primitive;
  const Point3d& reference = reference_[matches_[i].reference];
  const Point3d& current = current_[matches_[i].current];
  primitive.shape = Primitive::Shape::kPoint;
  primitive.p_reference = reference.p;
  primitive.p_current = current.p;
  primitive.sigma_p_m = sqrt((reference.Sigma.trace() + current.Sigma.trace()) / 3);
  return primitive;
}

double PointConstraints::mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const {
  const Point3d& reference = reference_[matches_[i].reference];
  const Point3d& current = current_[matches_[i].current];
  const Vector3 e = current.p - T * reference.p;
  // No eigenvalue of the covariance exceeds its trace, so s ≥ |e|² / trace. Most outliers are rejected by
  // this bound without an inverse.
  const double squared_norm = e.squaredNorm();
  const double trace = reference.Sigma.trace() + current.Sigma.trace();
  if (squared_norm > cutoff * trace) return squared_norm / trace;
  return e.dot(inverse(sum_of_covariances(T.R, reference.Sigma, current.Sigma)) * e);
}

namespace {

// The β part of the sums of one set, with J_ξ = [I, −[q]×]. The depth columns of F are multiples of p, so
// each product with them is `along` times a scalar.
class SharedSums {
 public:
  // W: information matrix of the match. We: W times its residual.
  void add(const NuisanceField& F, const Matrix3& W, const Vector3& We, const Vector3& q) {
    const Vector3 Wp = W.lazyProduct(F.p);
    const Vector3 moved = q.cross(Wp);
    const Vector3 turned = F.angular_rate(Wp);
    const double factors[kFactors] = {Wp[0],    Wp[1],     Wp[2],     moved[0],  moved[1],
                                      moved[2], turned[0], turned[1], turned[2], -F.p.dot(We)};
    const Pair along[kPairs] = {{F.along[0], F.along[1]}, {F.along[2], F.along[3]}};
    for (int i = 0; i < kFactors; ++i)
      for (int k = 0; k < kPairs; ++k) along_[i][k] += factors[i] * along[k];
    const double squared = F.p.dot(Wp);
    for (int i = 0; i < kDepth; ++i) {
      const double scaled = squared * F.along[i];
      for (int k = 0; k < kPairs; ++k) squares_[i][k] += scaled * along[k];
    }
    if (F.delay_s == 0) return;
    Matrix3 WF;
    for (int r = 0; r < 3; ++r) WF.row(r) = F.angular_rate(W.row(r).transpose()).transpose();
    rate_v_ += WF;
    for (int c = 0; c < kAngularRate; ++c) {
      rate_w_.col(c) += q.cross(WF.col(c));
      rate_rate_.col(c) += F.angular_rate(WF.col(c));
    }
    g_rate_ -= F.angular_rate(We);
  }

  void add_to(JointInformation& sum) const {
    constexpr int kAlong = 6 + kAngularRate;
    sum.H.block<kAngularRate, 3>(6, 0) += rate_v_.transpose();
    sum.H.block<kAngularRate, 3>(6, 3) += rate_w_.transpose();
    sum.H.block<kAngularRate, kAngularRate>(6, 6) += rate_rate_;
    sum.g.segment<kAngularRate>(6) += g_rate_;
    for (int i = 0; i < kDepth; ++i) {
      for (int k = 0; k < kFactors - 1; ++k) sum.H(kAlong + i, k) += along_[k][i / 2][i % 2];
      for (int k = 0; k <= i; ++k) sum.H(kAlong + i, kAlong + k) += squares_[i][k / 2][k % 2];
      sum.g[kAlong + i] += along_[kFactors - 1][i / 2][i % 2];
    }
    // Mirrors the lower triangle of these rows and columns.
    for (int r = 6; r < JointInformation::kSize; ++r)
      for (int c = 0; c < r; ++c) sum.H(c, r) = sum.H(r, c);
  }

 private:
  static constexpr int kAngularRate = NuisanceField::kAngularRate, kDepth = NuisanceField::kDepth;
  static constexpr int kFactors = 6 + kAngularRate + 1;  // motion, angular rate and gradient
  static constexpr int kPairs = kDepth / 2;
  Pair along_[kFactors][kPairs] = {};
  Pair squares_[kDepth][kPairs] = {};
  Matrix3 rate_v_ = Matrix3::Zero(), rate_w_ = Matrix3::Zero(), rate_rate_ = Matrix3::Zero();
  Vector3 g_rate_ = Vector3::Zero();
};

}  // namespace

double PointConstraints::linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                                   JointInformation& sum) const {
  double cost = 0;
  Matrix3 H_vv = Matrix3::Zero();
  Matrix3 H_vw = Matrix3::Zero();
  Matrix3 H_ww = Matrix3::Zero();  // lower triangle
  Vector3 g_v = Vector3::Zero();
  Vector3 g_w = Vector3::Zero();
  SharedSums of_shared;
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (inliers_[i] == 0) continue;
    const Point3d& reference = reference_[matches_[i].reference];
    const Point3d& current = current_[matches_[i].current];
    Vector3 p = current.p;
    const NuisanceField F = shared.field(current.p);
    if (shared.any()) p -= F * shared.value;
    const Vector3 e = p - T * reference.p;
    Symmetric3 W = inverse(sum_of_covariances(T.R, reference.Sigma, current.Sigma));
    Vector3 We = W * e;
    double weight = 1;
    cost += 0.5 * kernel(e.dot(We), weight);
    const Vector3 q = p - current.Sigma * We - T.t;  // R X*
    We *= weight;
    W = {W.xx * weight, W.xy * weight, W.xz * weight, W.yy * weight, W.yz * weight, W.zz * weight};

    g_v -= We;
    g_w -= q.cross(We);
    // W [q]× row by row, rᵀ [q]× = (r × q)ᵀ; then [q]×ᵀ (W [q]×) column by column, [q]×ᵀ c = c × q.
    Matrix3 rows;
    rows << W.xx, W.xy, W.xz, W.xy, W.yy, W.yz, W.xz, W.yz, W.zz;
    Matrix3 B;
    for (int r = 0; r < 3; ++r) {
      B(r, 0) = rows(r, 1) * q.z() - rows(r, 2) * q.y();
      B(r, 1) = rows(r, 2) * q.x() - rows(r, 0) * q.z();
      B(r, 2) = rows(r, 0) * q.y() - rows(r, 1) * q.x();
    }
    if (shared.any()) of_shared.add(F, rows, We, q);
    H_vv += rows;
    H_vw -= B;
    for (int c = 0; c < 3; ++c) {
      H_ww(0, c) += B(1, c) * q.z() - B(2, c) * q.y();
      H_ww(1, c) += B(2, c) * q.x() - B(0, c) * q.z();
      H_ww(2, c) += B(0, c) * q.y() - B(1, c) * q.x();
    }
  }
  sum.H.block<3, 3>(0, 0) += H_vv;
  sum.H.block<3, 3>(0, 3) += H_vw;
  sum.H.block<3, 3>(3, 0) += H_vw.transpose();
  sum.H.block<3, 3>(3, 3) += 0.5 * (H_ww + H_ww.transpose());
  sum.g.head<3>() += g_v;
  sum.g.segment<3>(3) += g_w;
  if (shared.any()) of_shared.add_to(sum);
  return cost;
}

}  // namespace plvo
