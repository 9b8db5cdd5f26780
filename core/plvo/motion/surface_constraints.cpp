// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/surface_constraints.hpp"

#include <algorithm>
#include <cstring>

#include "plvo/base/build.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/math/pair.hpp"

namespace plvo {
namespace {

// A match with a residual of more σ than this is on another surface.
constexpr double kGateSigmas = 5;
constexpr int kShared = NuisanceParameters::kCount;
constexpr int kJoint = JointInformation::kSize;
constexpr int kCommon = SurfaceForm::kCommon;
constexpr int kAll = kJoint + kCommon;
constexpr int kMotion = SurfaceForm::kMotion;
constexpr int kOthers = SurfaceForm::kOthers;
constexpr int kSize = SurfaceForm::kSize;

double normalised(const SurfaceMatch& match, const Vector3& e) {
  const double r = match.normal.dot(e);
  return r * r / match.variance;
}

// Sums over (ξ, β, γ). Only the lower triangle of H is filled.
struct Sums {
  double H[kAll][kAll] = {};
  double g[kAll] = {};
};

Pair pair_at(const double* two) {
  Pair pair;
  std::memcpy(&pair, two, sizeof pair);
  return pair;
}

void add_to(double* two, const Pair& pair) {
  const Pair sum = pair_at(two) + pair;
  std::memcpy(two, &sum, sizeof sum);
}

// A of one match. p: the homogeneous point, which defines the motion's columns: entry (i, j) of T moves e by
// p_j along axis i. others: the other columns; the last one is e at the start.
struct ErrorColumns {
  double p[4];
  Eigen::Matrix<double, 3, kOthers, Eigen::RowMajor> others;

  double operator()(int row, int column) const {
    if (column >= kMotion) return others(row, column - kMotion);
    return column / 4 == row ? p[column % 4] : 0;
  }
};

// Adds one match to the form's lower triangle, column by column. Used in size-optimised code.
[[maybe_unused]] void add_each(const ErrorColumns& A, const Matrix3& M, SurfaceForm& form) {
  for (int a = 0; a < kSize; ++a) {
    double Mv[3];
    for (int i = 0; i < 3; ++i) Mv[i] = M(i, 0) * A(0, a) + M(i, 1) * A(1, a) + M(i, 2) * A(2, a);
    for (int b = 0; b <= a; ++b) form.Q[a][b] += Mv[0] * A(0, b) + Mv[1] * A(1, b) + Mv[2] * A(2, b);
  }
}

// The same without the motion's zeros, two columns at once. Entries above the diagonal may be wrong. first:
// the other columns before it are zero.
void add(const ErrorColumns& A, int first, const Matrix3& M, SurfaceForm& form) {
  if constexpr (kSizeOptimised) return add_each(A, M, form);
  static_assert(kOthers % 2 == 0);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k)
      for (int j = 0; j < 4; ++j) {
        const double scaled = M(k, i) * A.p[j];  // M is symmetric up to rounding; index order as in add_each
        for (int l = 0; l < 4; l += 2) add_to(&form.Q[4 * i + j][4 * k + l], scaled * pair_at(A.p + l));
      }
  const auto& others = A.others;
  for (int a = first; a < kOthers; ++a) {
    double* row = form.Q[kMotion + a];
    double Mv[3];
    for (int i = 0; i < 3; ++i) {
      Mv[i] = M(i, 0) * others(0, a) + M(i, 1) * others(1, a) + M(i, 2) * others(2, a);
      for (int l = 0; l < 4; l += 2) add_to(row + 4 * i + l, Mv[i] * pair_at(A.p + l));
    }
    for (int b = first & ~1; b <= a; b += 2)
      add_to(row + kMotion + b, Mv[0] * pair_at(&others(0, b)) + Mv[1] * pair_at(&others(1, b)) +
                                    Mv[2] * pair_at(&others(2, b)));
  }
}

void clear(SurfaceForm& form) {
  for (auto& row : form.Q)
    for (double& entry : row) entry = 0;
}

void mirror(SurfaceForm& form) {
  for (int a = 0; a < kSize; ++a)
    for (int b = 0; b < a; ++b) form.Q[b][a] = form.Q[a][b];
}

// Derivative of T's entries with respect to ξ = (υ, ω): υ moves the last column, ω rotates the others, d(R p)
// = ω × R p.
struct Tangent {
  double d[6][kMotion] = {};
  explicit Tangent(const Matrix3& R) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const int last = (k + 2) % 3;
      d[k][4 * k + 3] = 1;
      for (int j = 0; j < 3; ++j) {
        d[3 + k][4 * next + j] = -R(last, j);
        d[3 + k][4 * last + j] = R(next, j);
      }
    }
  }
  double along(int k, const double* entries) const {
    double sum = 0;
    for (int i = 0; i < kMotion; ++i) sum += d[k][i] * entries[i];
    return sum;
  }
};

// Eliminates γ from the sums and adds their Schur complement to `sum`. Returns the reduction of the cost.
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
    : CostTerm(workspace.inliers.first(std::min(matches.size(), workspace.inliers.size()))),
      matches_(matches.first(inliers_.size())),
      form_(workspace.form.data()) {
  std::fill(inliers_.begin(), inliers_.end(), std::uint8_t{0});
}

double SurfaceConstraints::mahalanobis_squared(std::size_t i, const Se3& T) const {
  const SurfaceMatch& match = matches_[i];
  return normalised(match, T * match.p_reference - match.p_current);
}

void SurfaceConstraints::begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                               std::size_t every) {
  T_begin_ = T;
  if (matches_.empty()) return;
  std::fill(inliers_.begin(), inliers_.end(), std::uint8_t{0});
  clear(*form_);
  ErrorColumns A;
  A.others.setZero();
  for (std::size_t i = 0; i < matches_.size(); i += every) {
    const SurfaceMatch& match = matches_[i];
    const Vector3 offset = T * match.p_reference - match.p_current;
    Vector3 e = offset;
    if (shared.any()) {
      const NuisanceField field = shared.field(match.p_current, match.delay_s);
      A.others.block<3, kShared>(0, 0) = field.matrix();
      e += field * shared.value;
    }
    const double s = normalised(match, e);
    inliers_[i] = s <= kGateSigmas * kGateSigmas ? 1 : 0;
    if (inliers_[i] == 0) continue;
    double weight = 1;
    (void)kernel(s, weight);
    weight /= match.variance;
    const Vector3& n = match.normal;
    Matrix3 M = (weight * (1 + match.normal_variance)) * (n * n.transpose());
    for (int k = 0; k < 3; ++k) M(k, k) -= weight * match.normal_variance;
    A.others.block<3, kCommon>(0, kShared) = match.common;
    A.others.col(kOthers - 1) = offset;
    for (int k = 0; k < 3; ++k) A.p[k] = match.p_reference[k];
    A.p[3] = 1;
    add(A, shared.any() ? 0 : kShared, M, *form_);
  }
  mirror(*form_);
}

double SurfaceConstraints::linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel&,
                                     JointInformation& sum) const {
  if (matches_.empty()) return 0;
  const auto& Q = form_->Q;
  double x[kSize] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) x[4 * i + j] = T.R(i, j) - T_begin_.R(i, j);
    x[4 * i + 3] = T.t[i] - T_begin_.t[i];
  }
  for (int k = 0; k < kShared && shared.any(); ++k) x[kMotion + k] = shared.value[k];
  x[kSize - 1] = 1;
  double Qx[kSize] = {};
  double cost = 0;
  for (int a = 0; a < kSize; ++a) {
    for (int b = 0; b < kSize; ++b) Qx[a] += Q[a][b] * x[b];
    cost += 0.5 * Qx[a] * x[a];
  }
  const Tangent tangent(T.R);
  Sums sums;
  for (int a = 0; a < 6; ++a) {
    double column[kSize];
    for (int b = 0; b < kSize; ++b) column[b] = tangent.along(a, Q[b]);
    sums.g[a] = tangent.along(a, Qx);
    for (int b = 0; b <= a; ++b) sums.H[a][b] = tangent.along(b, column);
    for (int b = 6; b < kAll; ++b) sums.H[b][a] = column[kMotion + b - 6];
  }
  for (int a = 6; a < kAll; ++a) {
    sums.g[a] = Qx[kMotion + a - 6];
    for (int b = 6; b <= a; ++b) sums.H[a][b] = Q[kMotion + a - 6][kMotion + b - 6];
  }
  return cost - eliminate_common(sums, shared.any() ? kJoint : 6, sum);
}

}  // namespace plvo
