// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/minimal_set.hpp"

#include <Eigen/Geometry>

#include "plvo/math/absolute_orientation.hpp"
#include "plvo/math/cholesky.hpp"

namespace plvo {
namespace {

// Largest deviation of a side, an angle or a residual, and smallest height of a triangle, in SDs.
constexpr double kConsistencySigmas = 4;
constexpr double kHeightSigmas = 4;
// Two directions closer than this (sine of 6°) count as parallel, whatever their uncertainty.
constexpr double kMinSine = 0.1;

struct PointPair {
  Vector3 reference, current;
  double variance;  // of the difference along any one axis, m²
};
using Primitives = std::array<Primitive, 3>;
using PointPairs = std::array<PointPair, 3>;

double absolute(double x) { return x < 0 ? -x : x; }

PointPair pair_of(const Primitive& point) {
  return {point.p_reference, point.p_current, point.sigma_p_m * point.sigma_p_m};
}

// The point projected orthogonally onto the line, in each frame.
PointPair foot(const PointPair& point, const Primitive& line) {
  const double along = line.d_reference.dot(point.reference - line.p_reference);
  const double along_current = line.d_current.dot(point.current - line.p_current);
  // The error of the foot has three parts: that of the line across it, that of the point along it, and that
  // of the line's direction times the lever arm.
  const double lever = line.sigma_d_rad * along;
  return {line.p_reference + along * line.d_reference, line.p_current + along_current * line.d_current,
          line.sigma_p_m * line.sigma_p_m + point.variance + lever * lever};
}

double squared_distance_to_line(const Vector3& point, const Vector3& p, const Vector3& d) {
  return (point - p).cross(d).squaredNorm();
}

// Squared height of the triangle over its longest side.
double squared_height(const Vector3& a, const Vector3& b, const Vector3& c) {
  double longest = (b - a).squaredNorm();
  for (const double side : {(c - b).squaredNorm(), (a - c).squaredNorm()})
    longest = side > longest ? side : longest;
  return longest > 0 ? (b - a).cross(c - a).squaredNorm() / longest : 0;
}

MinimalSetStatus solve_points(const PointPairs& pairs, Se3& T) {
  double variance = 0;
  for (const PointPair& pair : pairs) variance = pair.variance > variance ? pair.variance : variance;
  const double least = kHeightSigmas * kHeightSigmas * variance;
  if (!(squared_height(pairs[0].reference, pairs[1].reference, pairs[2].reference) > least) ||
      !(squared_height(pairs[0].current, pairs[1].current, pairs[2].current) > least))
    return MinimalSetStatus::kDegenerate;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const double side = sqrt((pairs[j].reference - pairs[i].reference).squaredNorm());
    const double side_current = sqrt((pairs[j].current - pairs[i].current).squaredNorm());
    const double difference = side - side_current;
    if (!(difference * difference <=
          kConsistencySigmas * kConsistencySigmas * (pairs[i].variance + pairs[j].variance)))
      return MinimalSetStatus::kInconsistent;
  }
  const Vector3 centre = (pairs[0].reference + pairs[1].reference + pairs[2].reference) / 3;
  const Vector3 centre_current = (pairs[0].current + pairs[1].current + pairs[2].current) / 3;
  Matrix3 correlation = Matrix3::Zero();
  for (const PointPair& pair : pairs)
    correlation += (pair.current - centre_current) * (pair.reference - centre).transpose();
  T.R = best_rotation(correlation);
  T.t = centre_current - T.R * centre;
  return MinimalSetStatus::kSolved;
}

// Computes the translation that aligns three lines under a known rotation, by least squares across the lines:
// the second step of Zhang & Faugeras [38]. Returns false if the lines are parallel or do not meet within
// their uncertainty.
bool translation_of_lines(const Primitives& lines, const Matrix3& R, double sigma_rotation, Vector3& t) {
  Matrix3 A = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  for (const Primitive& line : lines) {
    const Matrix3 across = Matrix3::Identity() - line.d_current * line.d_current.transpose();
    A += across;
    b += across * (line.p_current - R * line.p_reference);
  }
  Cholesky<3> cholesky;
  if (!cholesky.factor(A)) return false;
  t = cholesky.solve(b);
  const Vector3 centre = (lines[0].p_reference + lines[1].p_reference + lines[2].p_reference) / 3;
  for (const Primitive& line : lines) {
    // The midpoints of the two segments may lie apart along the line. The error of the direction acts over
    // that lever arm. The error of the rotation acts over the distance from the centre; the translation
    // cannot compensate it.
    const Vector3 between = R * line.p_reference + t - line.p_current;
    const double lever = line.sigma_d_rad * line.d_current.dot(between);
    const double variance = line.sigma_p_m * line.sigma_p_m + lever * lever +
                            sigma_rotation * sigma_rotation * (line.p_reference - centre).squaredNorm();
    if (between.cross(line.d_current).squaredNorm() > 2 * kConsistencySigmas * kConsistencySigmas * variance)
      return false;
  }
  return true;
}

MinimalSetStatus solve_lines(const Primitives& lines, const Matrix3& R_expected, Se3& T) {
  double largest_sine_squared = 0;
  double sigma = 0;
  // Relative sign of each pair of directions: +1 or −1 if both frames determine it, 0 if the pair is too
  // close to perpendicular.
  double sign_of_pair[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const Primitive& a = lines[i];
    const Primitive& b = lines[(i + 1) % 3];
    const double cosine = a.d_reference.dot(b.d_reference);
    const double cosine_current = a.d_current.dot(b.d_current);
    const double sine_squared = a.d_reference.cross(b.d_reference).squaredNorm();
    largest_sine_squared = sine_squared > largest_sine_squared ? sine_squared : largest_sine_squared;
    sigma = a.sigma_d_rad > sigma ? a.sigma_d_rad : sigma;
    const double angle_tolerance =
        kConsistencySigmas * sqrt(a.sigma_d_rad * a.sigma_d_rad + b.sigma_d_rad * b.sigma_d_rad);
    // A change of the angle by ε changes its cosine by at most ε sin + ε²/2.
    const double tolerance = angle_tolerance * (sqrt(sine_squared) + 0.5 * angle_tolerance);
    if (absolute(absolute(cosine) - absolute(cosine_current)) > tolerance)
      return MinimalSetStatus::kInconsistent;
    if (absolute(cosine) > tolerance && absolute(cosine_current) > tolerance)
      sign_of_pair[i] = cosine * cosine_current > 0 ? 1 : -1;
  }
  const double least_sine = kHeightSigmas * sigma > kMinSine ? kHeightSigmas * sigma : kMinSine;
  if (!(largest_sine_squared > least_sine * least_sine)) return MinimalSetStatus::kDegenerate;

  constexpr double kBelowAnyTrace = -4;  // the trace of a rotation is at least −1
  double best_trace = kBelowAnyTrace;
  for (unsigned signs = 0; signs < 8; ++signs) {
    double s[3];
    for (unsigned i = 0; i < 3; ++i) s[i] = (signs >> i & 1) != 0 ? -1 : 1;
    if (s[0] * s[1] * sign_of_pair[0] < 0 || s[1] * s[2] * sign_of_pair[1] < 0 ||
        s[2] * s[0] * sign_of_pair[2] < 0)
      continue;
    Matrix3 correlation = Matrix3::Zero();
    for (unsigned i = 0; i < 3; ++i)
      correlation += s[i] * lines[i].d_current * lines[i].d_reference.transpose();
    const Matrix3 R = best_rotation(correlation);
    bool aligned = true;
    for (unsigned i = 0; i < 3; ++i) {
      const double limit = kConsistencySigmas * (lines[i].sigma_d_rad + sigma);
      aligned =
          aligned && (s[i] * lines[i].d_current - R * lines[i].d_reference).squaredNorm() <= limit * limit;
    }
    const Matrix3 turn = R_expected.transpose() * R;
    const double trace = turn.trace();
    Vector3 t;
    if (!aligned || trace <= best_trace ||
        !translation_of_lines(lines, R, sigma / sqrt(largest_sine_squared), t))
      continue;
    best_trace = trace;
    T = {R, t};
  }
  return best_trace > kBelowAnyTrace ? MinimalSetStatus::kSolved : MinimalSetStatus::kInconsistent;
}

}  // namespace

MinimalSetStatus solve_minimal_set(const Primitives& set, const Matrix3& R_expected, Se3& T) {
  // Sorts points first, so that only four cases remain.
  std::size_t order[3];
  std::size_t points = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (set[i].shape == Primitive::Shape::kPoint) order[points++] = i;
  std::size_t placed = points;
  for (std::size_t i = 0; i < 3; ++i)
    if (set[i].shape != Primitive::Shape::kPoint) order[placed++] = i;

  if (points == 0) return solve_lines(set, R_expected, T);
  PointPair first = pair_of(set[order[0]]);
  if (points == 1) return solve_points({first, foot(first, set[order[1]]), foot(first, set[order[2]])}, T);
  const PointPair second = pair_of(set[order[1]]);
  if (points == 3) return solve_points({first, second, pair_of(set[order[2]])}, T);
  // Two points and a line: projecting the point farther from the line gives the larger triangle.
  const Primitive& line = set[order[2]];
  const bool swap = squared_distance_to_line(second.reference, line.p_reference, line.d_reference) >
                    squared_distance_to_line(first.reference, line.p_reference, line.d_reference);
  return solve_points({first, second, foot(swap ? second : first, line)}, T);
}

}  // namespace plvo
