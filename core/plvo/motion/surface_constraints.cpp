// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/surface_constraints.hpp"

#include <algorithm>

#include "plvo/math/cholesky.hpp"

namespace plvo {
namespace {

// Beyond so many σ it is another surface.
constexpr double kGateSigmas = 5;
constexpr int kJoint = JointInformation::kSize;
constexpr int kCommon = 2;
constexpr int kAll = kJoint + kCommon;

double normalised(const SurfaceMatch& match, const Vector3& e) {
  const double r = match.normal.dot(e);
  return r * r / match.variance;
}

// Sums over (ξ, β, γ); of H the lower triangle.
struct Sums {
  double H[kAll][kAll] = {};
  double g[kAll] = {};
};

// Vᵀ M V and Vᵀ M e, with M e as it is.
void add(const Matrix<3, kAll>& V, const Matrix3& M, const Vector3& Me, int first_unused, Sums& sums) {
  for (int a = 0; a < kAll; ++a) {
    if (a >= first_unused && a < kJoint) continue;
    const Vector3 column = V.col(a);
    const Vector3 Mv = M.lazyProduct(column);
    sums.g[a] += column.dot(Me);
    for (int b = 0; b <= a; ++b)
      if (b < first_unused || b >= kJoint) sums.H[a][b] += Mv.dot(V.col(b));
  }
}

// Takes γ out of the sums: their Schur complement, added to `sum`. Returns what the cost loses.
double eliminate_common(const Sums& sums, int size, JointInformation& sum) {
  const double aa = sums.H[kJoint][kJoint] + 1;
  const double ab = sums.H[kJoint + 1][kJoint];
  const double bb = sums.H[kJoint + 1][kJoint + 1] + 1;
  const double determinant = aa * bb - ab * ab;
  const double inverse[2][2] = {{bb / determinant, -ab / determinant}, {-ab / determinant, aa / determinant}};
  double step[2];
  for (int k = 0; k < kCommon; ++k)
    step[k] = inverse[k][0] * sums.g[kJoint] + inverse[k][1] * sums.g[kJoint + 1];
  for (int a = 0; a < size; ++a) {
    const double ca = sums.H[kJoint][a];
    const double cb = sums.H[kJoint + 1][a];
    sum.g[a] += sums.g[a] - ca * step[0] - cb * step[1];
    const double gain[2] = {inverse[0][0] * ca + inverse[0][1] * cb, inverse[1][0] * ca + inverse[1][1] * cb};
    for (int b = 0; b <= a; ++b) {
      const double entry = sums.H[a][b] - gain[0] * sums.H[kJoint][b] - gain[1] * sums.H[kJoint + 1][b];
      sum.H(a, b) += entry;
      if (a != b) sum.H(b, a) += entry;
    }
  }
  return 0.5 * (sums.g[kJoint] * step[0] + sums.g[kJoint + 1] * step[1]);
}

}  // namespace

SurfaceConstraints::SurfaceConstraints(std::span<const SurfaceMatch> matches, const Workspace& workspace)
    : ConstraintSet(workspace.inliers.first(std::min(matches.size(), workspace.inliers.size()))),
      matches_(matches.first(inliers_.size())),
      held_(workspace.held.first(inliers_.size())) {
  std::fill(inliers_.begin(), inliers_.end(), std::uint8_t{0});
}

double SurfaceConstraints::mahalanobis_squared(std::size_t i, const Se3& T, double) const {
  const SurfaceMatch& match = matches_[i];
  return normalised(match, T * match.p_reference - match.p_current);
}

void SurfaceConstraints::begin(const Se3& T, const SharedErrors& shared) {
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    const SurfaceMatch& match = matches_[i];
    Vector3 e = T * match.p_reference - match.p_current;
    if (shared.any()) e += shared.fields(match.p_current, match.delay_s).lazyProduct(shared.value);
    held_[i] = normalised(match, e);
    inliers_[i] = held_[i] <= kGateSigmas * kGateSigmas ? 1 : 0;
  }
}

double SurfaceConstraints::linearize(const Se3& T, const SharedErrors& shared, const RobustKernel& kernel,
                                     JointInformation& sum) const {
  const int size = shared.any() ? kJoint : 6;
  Sums sums;
  Matrix<3, kAll> V = Matrix<3, kAll>::Zero();
  V.block<3, 3>(0, 0).setIdentity();
  double cost = 0;
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (inliers_[i] == 0) continue;
    const SurfaceMatch& match = matches_[i];
    const Vector3 q = T.R * match.p_reference;
    Vector3 e = q + T.t - match.p_current;
    V.block<3, 3>(0, 3) = -skew(q);
    if (shared.any()) {
      const Matrix<3, SharedErrors::kCount> F = shared.fields(match.p_current, match.delay_s);
      e += F.lazyProduct(shared.value);
      V.block<3, SharedErrors::kCount>(0, 6) = F;
    }
    V.block<3, kCommon>(0, kJoint) = match.common;
    double weight = 1;
    (void)kernel(held_[i], weight);
    weight /= match.variance;
    const Vector3& n = match.normal;
    Matrix3 M = (weight * (1 + match.normal_variance)) * (n * n.transpose());
    for (int k = 0; k < 3; ++k) M(k, k) -= weight * match.normal_variance;
    const Vector3 Me = M.lazyProduct(e);
    cost += 0.5 * e.dot(Me);
    add(V, M, Me, size, sums);
  }
  return cost - eliminate_common(sums, size, sum);
}

}  // namespace plvo
