// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/line_constraints.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/pair.hpp"

namespace plvo {
namespace {

// Minimum length of a segment in SDs of its ends. The direction of a shorter one is too uncertain to
// linearise.
constexpr double kMinLengthSigmas = 4;
// Limit of the squared Mahalanobis distance of a match's four offsets, the 99 % quantile of χ²(4). A larger
// offset is not noise, so it holds no information about the noise along the line.
constexpr double kFarthestNoise = 13.3;

bool is_measurement(const Line3d& line) {
  Cholesky<6> cholesky;
  if (!line.a.allFinite() || !line.b.allFinite() || !line.Sigma.allFinite()) return false;
  const double trace = line.Sigma.trace();
  return trace <= 2 * kMaxVarianceM2 && cholesky.factor(line.Sigma) &&
         (line.b - line.a).squaredNorm() > kMinLengthSigmas * kMinLengthSigmas * trace / 6;
}

// A measured segment relative to an infinite line through q with the frame G = [U d].
struct EndOffsets {
  Vector4 e;          // across the line: Uᵀ (A − q), Uᵀ (B − q)
  Vector2 lambda;     // along the line: dᵀ (A − q), dᵀ (B − q)
  Matrix4 C;          // covariance of e
  Matrix<2, 4> C_le;  // covariance of lambda with e
};

// Writes the covariance of the offsets of end i across the line with those of end j, a block of Uᵀ Λ U, and
// returns that of the offset along the line, a row of dᵀ Λ U. Both columns are computed at once.
inline Pair observe_ends(const Line3d& line, int i, int j, const Matrix3& G, Matrix4& C) {
  const Pair U[3] = {{G(0, 0), G(0, 1)}, {G(1, 0), G(1, 1)}, {G(2, 0), G(2, 1)}};
  Pair right[3];
  for (int r = 0; r < 3; ++r)
    right[r] = line.Sigma(3 * i + r, 3 * j) * U[0] + line.Sigma(3 * i + r, 3 * j + 1) * U[1] +
               line.Sigma(3 * i + r, 3 * j + 2) * U[2];
  Pair row[3];
  for (int k = 0; k < 3; ++k) row[k] = G(0, k) * right[0] + G(1, k) * right[1] + G(2, k) * right[2];
  for (int k = 0; k < 2; ++k)
    for (int c = 0; c < 2; ++c) C(2 * i + k, 2 * j + c) = row[k][c];
  return row[2];
}

EndOffsets observe(const Line3d& line, const Vector3& q, const Matrix3& G) {
  EndOffsets offsets;
  const Vector3 a = G.transpose().lazyProduct(line.a - q);
  const Vector3 b = G.transpose().lazyProduct(line.b - q);
  offsets.e << a.x(), a.y(), b.x(), b.y();
  offsets.lambda << a.z(), b.z();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const Pair along = observe_ends(line, i, j, G, offsets.C);
      for (int c = 0; c < 2; ++c) offsets.C_le(i, 2 * j + c) = along[c];
    }
  return offsets;
}

// Linear interpolation of displacements from two stations on the line to two others, N ⊗ I₂.
struct Interpolation {
  double n[2][2];
  Interpolation(const Vector2& from, const Vector2& to) {
    for (int i = 0; i < 2; ++i) {
      const double t = (to[i] - from[0]) / (from[1] - from[0]);
      n[i][0] = 1 - t;
      n[i][1] = t;
    }
  }
  Vector4 operator*(const Vector4& y) const {
    Vector4 result;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k) result[2 * i + k] = n[i][0] * y[k] + n[i][1] * y[2 + k];
    return result;
  }
  Vector4 transpose_times(const Vector4& y) const {
    Vector4 result;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k) result[2 * i + k] = n[0][i] * y[k] + n[1][i] * y[2 + k];
    return result;
  }
  // Adds the block of N C Nᵀ with the rows of end r and the columns of end i to the same block of `sum`.
  void add_sandwich(const Matrix4& C, int r, int i, Matrix4& sum) const {
    Pair NC[4];
    for (int c = 0; c < 4; ++c) NC[c] = n[r][0] * Pair{C(0, c), C(1, c)} + n[r][1] * Pair{C(2, c), C(3, c)};
    for (int k = 0; k < 2; ++k) {
      const Pair rows = n[i][0] * NC[k] + n[i][1] * NC[2 + k];
      for (int row = 0; row < 2; ++row) sum(2 * r + row, 2 * i + k) += rows[row];
    }
  }
};

// A line through q along d in reference coordinates, and the weighted offsets of the segments in each frame,
// w_current = W c and w_reference = −Nᵀ W c. The weighted offsets determine the positions of the ends along
// the line.
struct Landmark {
  Vector3 q, d;
  Vector4 w_reference, w_current;
};

// One match at (T, landmark). The weighted offsets are limited to what can be noise (kFarthestNoise).
struct Observed {
  Cholesky<4> W;         // factor of C' + N C Nᵀ
  Vector4 offset;        // N e
  Vector4 w;             // W (e' − N e)
  Vector4 w_reference;   // −Nᵀ w
  Vector4 y;             // the landmark's best displacement across the line at its stations
  Vector2 stations;      // λ_A, λ_B of the reference frame
  Vector2 ends;          // λ'_A, λ'_B of the current frame
  Matrix3 G, G_current;  // line frames
};

// first: offsets of the reference segment in the line frame at.G. Returns false if the covariance has no
// Cholesky factor.
bool observe_both(const EndOffsets& first, const Line3d& current, const Se3& T, const Landmark& landmark,
                  Observed& at) {
  at.G_current = T.R.lazyProduct(at.G);
  EndOffsets second = observe(current, T * landmark.q, at.G_current);

  // The optimal positions along the line are the measured ones, corrected through the correlation of λ and e:
  // λ* = λ − C_le C⁻¹ e. At the landmark's optimum C'⁻¹ e' = w_current and C⁻¹ e = w_reference.
  at.stations = first.lambda - Vector2(first.C_le.lazyProduct(landmark.w_reference));
  at.ends = second.lambda - Vector2(second.C_le.lazyProduct(landmark.w_current));
  const Interpolation N(at.stations, at.ends);

  at.offset = N * first.e;
  for (int r = 0; r < 2; ++r)
    for (int i = 0; i <= r; ++i) N.add_sandwich(first.C, r, i, second.C);
  if (!at.W.factor(second.C)) return false;
  const Vector4 c = second.e - at.offset;
  at.w = at.W.solve(c);
  at.w_reference = -N.transpose_times(at.w);
  at.y = first.e - Vector4(first.C.lazyProduct(at.w_reference));
  const double squared = c.dot(at.w);
  const double noise = squared > kFarthestNoise ? kFarthestNoise / squared : 1;
  at.w *= noise;
  at.w_reference *= noise;
  return true;
}

Landmark moved(const Landmark& landmark, const Observed& at) {
  const Matrix<3, 2> U = at.G.block<3, 2>(0, 0);
  const Vector3 at_a = U.lazyProduct(at.y.head<2>());
  const Vector3 at_b = U.lazyProduct(at.y.tail<2>());
  const Vector3 slope = (at_b - at_a) / (at.stations[1] - at.stations[0]);
  Landmark result;
  result.q = landmark.q + at_a - at.stations[0] * slope;
  result.d = landmark.d + slope;
  result.d *= 1 / sqrt(result.d.squaredNorm());
  result.w_reference = at.w_reference;
  result.w_current = at.w;
  return result;
}

// Columns of the motion, of the nuisance parameters and of the residual. Their number is even.
constexpr int kColumnPairs = (JointInformation::kSize + 1) / 2;
static_assert(JointInformation::kSize % 2 == 1);
using Columns = Matrix<4, 2 * kColumnPairs>;

// Columns ← L⁻¹ columns, two at a time.
void whiten_columns(const Cholesky<4>& L, const Columns& columns, int pairs,
                    Pair (&whitened)[4][kColumnPairs]) {
  for (int pair = 0; pair < pairs; ++pair) {
    Pair column[4];
    for (int k = 0; k < 4; ++k) column[k] = Pair{columns(k, 2 * pair), columns(k, 2 * pair + 1)};
    L.solve_lower(column);
    for (int k = 0; k < 4; ++k) whitened[k][pair] = column[k];
  }
}

// H += weight · Aᵀ A, with A the whitened columns. Fills at least the lower triangle.
void add_products(const Pair (&A)[4][kColumnPairs], int pairs, double weight,
                  Pair (&H)[2 * kColumnPairs][kColumnPairs]) {
  for (int r = 0; r < 2 * pairs; ++r) {
    double row[4];
    for (int k = 0; k < 4; ++k) row[k] = weight * A[k][r / 2][r % 2];
    for (int pair = 0; 2 * pair <= r; ++pair)
      H[r][pair] += row[0] * A[0][pair] + row[1] * A[1][pair] + row[2] * A[2][pair] + row[3] * A[3][pair];
  }
}

}  // namespace

LineConstraints::LineConstraints(std::span<const Line3d> reference, std::span<const Line3d> current,
                                 std::span<const Match> matches, const Workspace& workspace)
    : ConstraintSet(workspace.inliers.first(std::min(matches.size(), workspace.inliers.size()))),
      reference_(reference),
      current_(current),
      matches_(matches.first(inliers_.size())),
      usable_(workspace.usable.first(inliers_.size())),
      references_(workspace.references.first(inliers_.size())),
      held_(workspace.held.first(inliers_.size())) {
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    const Match& match = matches_[i];
    inliers_[i] = 0;
    usable_[i] = match.reference < reference_.size() && match.current < current_.size() &&
                 is_measurement(reference_[match.reference]) && is_measurement(current_[match.current]);
    if (usable_[i] == 0) continue;
    const Line3d& line = reference_[match.reference];
    const Vector3 d = line.b - line.a;
    const double length = sqrt(d.squaredNorm());
    Reference& summary = references_[i];
    summary.q = 0.5 * (line.a + line.b);
    summary.frame = frame_along(d / length);
    summary.half_length = 0.5 * length;
    summary.C = observe(line, summary.q, summary.frame).C;
  }
}

Primitive LineConstraints::primitive(std::size_t i) const {
  Primitive primitive;
  const Reference& reference = references_[i];
  const Line3d& current = current_[matches_[i].current];
  const Vector3 d_current = current.b - current.a;
  const double length_current = sqrt(d_current.squaredNorm());
  primitive.shape = Primitive::Shape::kLine;
  primitive.p_reference = reference.q;
  primitive.p_current = 0.5 * (current.a + current.b);
  primitive.d_reference = reference.frame.col(2);
  primitive.d_current = d_current / length_current;
  // Upper bounds of the variance across the line, from the traces there: for the mean of the two ends and for
  // their difference.
  const Matrix4& C = reference.C;
  const double ends = C.trace();
  const double cross = C(0, 2) + C(1, 3);
  const Matrix6& S = current.Sigma;
  const Vector3& d = primitive.d_current;
  const auto across = [&](int row, int column) {
    const Matrix3 block = S.block<3, 3>(row, column);
    return block.trace() - d.dot(block * d);
  };
  const double ends_current = across(0, 0) + across(3, 3);
  const double cross_current = across(3, 0);
  primitive.sigma_p_m = sqrt((ends + 2 * cross + ends_current + 2 * cross_current) / 4);
  primitive.sigma_d_rad = sqrt((ends - 2 * cross) / (4 * reference.half_length * reference.half_length) +
                               (ends_current - 2 * cross_current) / (length_current * length_current));
  return primitive;
}

double LineConstraints::mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const {
  const Reference& reference = references_[i];
  const Line3d& current = current_[matches_[i].current];
  const Matrix3 G = T.R.lazyProduct(reference.frame);
  const Vector3 q = T * reference.q;
  const Vector3 a = G.transpose().lazyProduct(current.a - q);
  const Vector3 b = G.transpose().lazyProduct(current.b - q);
  const Interpolation N(Vector2(-reference.half_length, reference.half_length), Vector2(a.z(), b.z()));
  // As for points, the trace bounds the largest eigenvalue, here that of C' + N C Nᵀ.
  const double squared_norm = a.head<2>().squaredNorm() + b.head<2>().squaredNorm();
  double N_squared = 0;
  for (const auto& row : N.n) N_squared += row[0] * row[0] + row[1] * row[1];
  const double bound = current.Sigma.trace() + N_squared * reference.C.trace();
  if (!(squared_norm <= cutoff * bound)) return squared_norm / bound;

  // Only the lower triangle of the covariance is needed. The offsets of one end have a squared distance of
  // their own, which that of both ends exceeds; it rejects most of the other outliers.
  Matrix4 C;
  const auto add_block = [&](int row, int column) {
    (void)observe_ends(current, row, column, G, C);
    N.add_sandwich(reference.C, row, column, C);
  };
  const Vector4 e(a.x(), a.y(), b.x(), b.y());
  for (int end = 0; end < 2; ++end) {
    add_block(end, end);
    const double* S = &C(2 * end, 2 * end);
    const double x = e[2 * end];
    const double y = e[2 * end + 1];
    const double determinant = S[0] * S[5] - S[1] * S[1];
    const double scaled = x * x * S[5] - 2 * x * y * S[1] + y * y * S[0];
    if (determinant > 0 && scaled > cutoff * determinant) return scaled / determinant;
  }
  add_block(1, 0);
  Cholesky<4> cholesky;
  if (!cholesky.factor(C)) return 2 * cutoff;
  return cholesky.solve_lower(e).squaredNorm();
}

void LineConstraints::begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel&,
                            std::size_t) {
  for (std::size_t i = 0; i < matches_.size(); ++i)
    if (inliers_[i] != 0 && !hold(i, T, shared)) inliers_[i] = 0;
}

bool LineConstraints::hold(std::size_t i, const Se3& T, const NuisanceParameters& shared) {
  Line3d current = current_[matches_[i].current];
  if (shared.any()) {
    current.a -= shared.shift(current.a);
    current.b -= shared.shift(current.b);
  }
  // One Gauss–Newton step leads from the measured line to the optimal one. A second step would move it only
  // by the square of the first step over the segment's length.
  const Reference& own = references_[i];
  Landmark landmark{own.q, own.frame.col(2), Vector4::Zero(), Vector4::Zero()};
  Observed at;
  at.G = own.frame;
  // The reference segment has no offset from its own line.
  EndOffsets first{Vector4::Zero(), {-own.half_length, own.half_length}, own.C, Matrix<2, 4>::Zero()};
  if (!observe_both(first, current, T, landmark, at)) return false;
  landmark = moved(landmark, at);
  at.G = frame_along(landmark.d);
  first = observe(reference_[matches_[i].reference], landmark.q, at.G);
  if (!observe_both(first, current, T, landmark, at)) return false;
  Held& held = held_[i];
  for (int end = 0; end < 2; ++end) {
    held.ends[end] = landmark.q + at.ends[end] * landmark.d;
    held.across[end] = at.G_current.col(end);
  }
  held.offset = at.offset;
  held.W = at.W;
  return true;
}

double LineConstraints::linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                                  JointInformation& sum) const {
  const int size = shared.any() ? JointInformation::kSize : 6;
  const int pairs = size / 2 + 1;
  double cost = 0;
  Pair H[2 * kColumnPairs][kColumnPairs] = {};  // two columns each; the lower triangle; the last row holds −g
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (inliers_[i] == 0) continue;
    const Held& held = held_[i];
    const Line3d& current = current_[matches_[i].current];
    // −∂c/∂(ξ, β) and c, one row per end and direction u across the line: [uᵀ, (S × u)ᵀ, uᵀ F]. S is the
    // position of the end on the line minus t.
    Columns columns;
    columns.col(2 * pairs - 1).setZero();
    for (int end = 0; end < 2; ++end) {
      const Vector3& measured = end == 0 ? current.a : current.b;
      const Vector3 S = T.R.lazyProduct(held.ends[end]);
      Vector3 off = measured - T.t - S;
      if (shared.any()) {
        const NuisanceField field = shared.field(measured);
        off -= field * shared.value;
        for (int k = 0; k < 2; ++k)
          columns.block<1, NuisanceParameters::kCount>(2 * end + k, 6) =
              field.transpose_times(held.across[k]).transpose();
      }
      for (int k = 0; k < 2; ++k) {
        const Vector3& u = held.across[k];
        const int row = 2 * end + k;
        columns.block<1, 3>(row, 0) = u.transpose();
        columns.block<1, 3>(row, 3) = S.cross(u).transpose();
        columns(row, size) = u.dot(off) - held.offset[row];
      }
    }
    Pair whitened[4][kColumnPairs];
    whiten_columns(held.W, columns, pairs, whitened);
    double squared = 0;
    for (const auto& row : whitened) squared += row[size / 2][size % 2] * row[size / 2][size % 2];
    double weight = 1;
    cost += 0.5 * kernel(squared, weight);
    add_products(whitened, pairs, weight, H);
  }
  for (int r = 0; r < size; ++r) {
    for (int c = 0; c < size; ++c) sum.H(r, c) += r >= c ? H[r][c / 2][c % 2] : H[c][r / 2][r % 2];
    sum.g[r] -= H[size][r / 2][r % 2];
  }
  return cost;
}

}  // namespace plvo
