// SPDX-License-Identifier: Apache-2.0
// A frame matched with two references at once, and its problem linearised and solved.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "simulated_pair.hpp"

namespace plvo::test {

struct TwoReferences {
  TwoReferences(std::uint64_t seed, int point_count, int line_count, bool silent = false)
      : memory(1 << 20), arena(memory) {
    Gaussian gaussian(seed);
    truth = random_motion(gaussian);
    T_1_0 = boxplus(Se3{}, (Vector6() << 0.08, -0.05, 0.04, 0.05, 0.1, -0.04).finished());
    pairs[0].truth = truth;
    pairs[1].truth = truth * T_1_0.inverse();
    gaussian.set_silent(silent);
    for (SimulatedPair& pair : pairs) {
      for (int i = 0; i < point_count; ++i) pair.add_point(gaussian, random_point(gaussian));
      for (int i = 0; i < line_count; ++i) pair.add_random_line(gaussian);
    }
    references[1].T_reference_base = T_1_0;
  }

  // What reference 1 measured, in the coordinates of reference 0.
  SimulatedPair carried_to_base() const {
    SimulatedPair pair = pairs[1];
    pair.truth = truth;
    const Se3 T_0_1 = T_1_0.inverse();
    for (Point3d& point : pair.points_reference)
      point = {T_0_1 * point.p, T_0_1.R * point.Sigma * T_0_1.R.transpose()};
    Matrix6 R = Matrix6::Zero();
    R.block<3, 3>(0, 0) = T_0_1.R;
    R.block<3, 3>(3, 3) = T_0_1.R;
    for (Line3d& line : pair.lines_reference)
      line = {T_0_1 * line.a, T_0_1 * line.b, R * line.Sigma * R.transpose()};
    return pair;
  }

  struct MatchedWith {
    const SimulatedPair& pair;
    std::size_t reference;
  };
  std::vector<ConstraintSet*> sets_of(std::span<const MatchedWith> matched, double correlation = 0) {
    points.clear();
    lines.clear();
    points.reserve(matched.size());
    lines.reserve(matched.size());
    arena.rewind(0);
    std::vector<ConstraintSet*> sets;
    for (const auto& [pair, reference] : matched) {
      points.emplace_back(pair.points_reference, pair.points_current, pair.point_matches,
                          PointConstraints::Workspace::take(arena, pair.point_matches.size()));
      lines.emplace_back(pair.lines_reference, pair.lines_current, pair.line_matches,
                         LineConstraints::Workspace::take(arena, pair.line_matches.size()));
      points.back().set_reference(reference, correlation);
      lines.back().set_reference(reference, correlation);
      sets.insert(sets.end(), {&points.back(), &lines.back()});
    }
    for (ConstraintSet* set : sets) flag_all(*set);
    return sets;
  }
  std::vector<ConstraintSet*> sets_of(const SimulatedPair& first, const SimulatedPair& second,
                                      std::size_t reference_of_second, double correlation = 0) {
    return sets_of(std::array{MatchedWith{first, 0}, MatchedWith{second, reference_of_second}}, correlation);
  }

  std::vector<std::byte> memory;
  Arena arena;
  Se3 truth, T_1_0;
  std::array<SimulatedPair, 2> pairs;
  MotionReferences references;
  std::vector<PointConstraints> points;
  std::vector<LineConstraints> lines;
};

struct Linearization {
  double cost = 0;
  Matrix6 H;
  Vector6 g;
};
inline Linearization linearize(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                               const Se3& T, bool marginalise = true, const Vector6& step = Vector6::Zero()) {
  MotionReferences judged = references;
  if (!marginalise)
    for (MotionReference& reference : judged) reference.covariance.setZero();
  const CostTerms terms(sets);
  MotionProblem problem(terms, judged, {}, MotionProblem::make_kernels(terms, RobustLoss::kNone), T);
  Linearization out;
  out.cost = problem.linearize(step, out.H, out.g);
  return out;
}

inline Solution solve(std::span<ConstraintSet* const> sets, const MotionReferences& references,
                      const Se3& start) {
  return settle(CostTerms(sets), references, RobustLoss::kHuber, start);
}

// |A − B| where metres and radians, known well and known badly, weigh alike: in units of B's own diagonal.
inline double difference(const Matrix6& A, const Matrix6& B) {
  double largest = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      largest = std::max(largest, std::fabs(A(i, j) - B(i, j)) / std::sqrt(B(i, i) * B(j, j)));
  return largest;
}
inline double difference(const Vector6& a, const Vector6& b, const Matrix6& H) {
  const Vector6 d = a - b;
  return std::sqrt(d.dot(Vector6(solve_positive(H, d))));
}

// Away from the truth, by millimetres and milliradians.
inline const Vector6 kAway = (Vector6() << 0.004, -0.003, 0.002, 0.002, -0.001, 0.003).finished();

}  // namespace plvo::test
