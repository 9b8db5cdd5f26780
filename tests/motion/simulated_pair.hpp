// SPDX-License-Identifier: Apache-2.0
// Two frames of a camera that looks at random points and lines, measured with exactly the Gaussian noise that
// their covariances state: what the estimator assumes, so that its covariance can be held to its word.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "dense.hpp"
#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/base/random.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_estimator.hpp"

namespace plvo::test {

class Gaussian {
 public:
  explicit Gaussian(std::uint64_t seed) : random_(seed) {}
  double operator()() {  // Box–Muller
    if (silent_) return 0;
    // One after the other: the order in which a product's factors are evaluated is the compiler's.
    const double u = random_.uniform() + 1e-12;
    const double angle = 6.283185307179586 * random_.uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(angle);
  }
  double uniform(double low, double high) { return low + (high - low) * random_.uniform(); }
  template <int N>
  Vector<N> vector() {
    Vector<N> v;
    for (int i = 0; i < N; ++i) v[i] = (*this)();
    return v;
  }
  template <int N>
  Vector<N> draw(const Matrix<N, N>& Sigma) {
    return product(cholesky(Sigma), vector<N>());
  }
  Random& random() { return random_; }
  // Silent: no noise, but uniform() goes on.
  void set_silent(bool silent) { silent_ = silent; }

 private:
  bool silent_ = false;
  Random random_;
};

inline Matrix3 kinect_covariance(const Vector3& p) {
  const Pinhole camera;
  return observe_point(camera, camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy,
                       p.z(), 0.7, DepthNoise{}.sigma(p.z()))
      .Sigma;
}

// Covariance (10) of a straight-line fit through n samples, ends pinned along the line by one sample each:
// the ends of a fitted line are correlated by −1/2 across it.
inline Matrix6 line_covariance(const Vector3& a, const Vector3& b, double samples) {
  const Matrix3 S = kinect_covariance(0.5 * (a + b));
  const Vector3 d = (b - a).normalized();
  const Matrix3 along = (1 / d.dot(S.inverse() * d)) * d * d.transpose();
  Matrix6 Lambda;
  Lambda.block<3, 3>(0, 0) = 4 / samples * S + along;
  Lambda.block<3, 3>(3, 3) = 4 / samples * S + along;
  Lambda.block<3, 3>(0, 3) = -2 / samples * S;
  Lambda.block<3, 3>(3, 0) = -2 / samples * S;
  return Lambda;
}

inline Vector3 random_point(Gaussian& gaussian) {
  const double z = gaussian.uniform(0.8, 4);
  return {gaussian.uniform(-0.55, 0.55) * z, gaussian.uniform(-0.4, 0.4) * z, z};
}

inline Vector3 random_direction(Gaussian& gaussian) {
  const double z = gaussian.uniform(-1, 1);
  const double angle = gaussian.uniform(0, 6.283185307179586);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

struct SimulatedPair {
  Se3 truth;  // T_current_reference
  std::vector<Point3d> points_reference, points_current;
  std::vector<Line3d> lines_reference, lines_current;
  std::vector<Match> point_matches, line_matches;

  void add_point(Gaussian& gaussian, const Vector3& p, bool outlier = false) {
    const Vector3 q = outlier ? truth * random_point(gaussian) : truth * p;
    const Matrix3 S = kinect_covariance(p);
    const Matrix3 S_current = kinect_covariance(q);
    const auto i = static_cast<std::uint16_t>(points_reference.size());
    points_reference.push_back({p + gaussian.draw<3>(S), S});
    points_current.push_back({q + gaussian.draw<3>(S_current), S_current});
    point_matches.push_back({i, i});
  }

  // The current frame sees another stretch of the line, in either direction.
  void add_line(Gaussian& gaussian, const Vector3& a, const Vector3& b, bool outlier = false) {
    Vector3 from = truth * (a + gaussian.uniform(-0.2, 0.2) * (b - a));
    Vector3 to = truth * (b + gaussian.uniform(-0.2, 0.2) * (b - a));
    if (outlier) {
      from = truth * random_point(gaussian);
      to = from + 0.5 * random_direction(gaussian);
    }
    if (gaussian.random().below(2) == 1) std::swap(from, to);
    const Matrix6 S = line_covariance(a, b, 40);
    const Matrix6 S_current = line_covariance(from, to, 40);
    const Vector6 noise = gaussian.draw<6>(S);
    const Vector6 noise_current = gaussian.draw<6>(S_current);
    const auto i = static_cast<std::uint16_t>(lines_reference.size());
    lines_reference.push_back({a + noise.head<3>(), b + noise.tail<3>(), S});
    lines_current.push_back({from + noise_current.head<3>(), to + noise_current.tail<3>(), S_current});
    line_matches.push_back({i, i});
  }
  void add_random_line(Gaussian& gaussian, bool outlier = false) {
    const Vector3 a = random_point(gaussian);
    add_line(gaussian, a, a + gaussian.uniform(0.3, 0.8) * random_direction(gaussian), outlier);
  }
};

inline Se3 random_motion(Gaussian& gaussian) {
  Vector6 delta;
  delta << 0.05 * gaussian.vector<3>(), 0.05 * gaussian.vector<3>();
  return boxplus(Se3{}, delta);
}

// n points and m lines, of which the first outlier_share are wrong.
inline SimulatedPair simulate(Gaussian& gaussian, int n, int m, double outlier_share = 0) {
  SimulatedPair pair;
  pair.truth = random_motion(gaussian);
  for (int i = 0; i < n; ++i) pair.add_point(gaussian, random_point(gaussian), i < outlier_share * n);
  for (int i = 0; i < m; ++i) pair.add_random_line(gaussian, i < outlier_share * m);
  return pair;
}

// The two kinds over one pair, with storage, and the estimator behind them.
struct Bench {
  explicit Bench(std::size_t bytes = 1 << 20) : memory(bytes), arena(memory) {}

  void load(const SimulatedPair& pair) {
    arena.rewind(0);
    points.emplace_back(pair.points_reference, pair.points_current, pair.point_matches,
                        PointConstraints::Workspace::take(arena, pair.point_matches.size()));
    lines.emplace_back(pair.lines_reference, pair.lines_current, pair.line_matches,
                       LineConstraints::Workspace::take(arena, pair.line_matches.size()));
    sets = {&points.back(), &lines.back()};
  }
  MotionEstimate estimate(const SimulatedPair& pair, const MotionConfig& config = {}, std::uint64_t seed = 1,
                          const MotionStart& start = nullptr,
                          const LmOptions& lm = {.max_iterations = 20, .step_tolerance = 1e-7}) {
    points.clear();
    lines.clear();
    load(pair);
    return estimate_motion(sets, {}, MotionReferences{}, config, lm, seed, start, arena);
  }

  std::vector<std::byte> memory;
  Arena arena;
  std::vector<PointConstraints> points;
  std::vector<LineConstraints> lines;
  std::vector<ConstraintSet*> sets;
};

inline void flag_all(ConstraintSet& set) {
  for (std::size_t i = 0; i < set.size(); ++i) set.inliers()[i] = set.usable(i) ? 1 : 0;
}

struct Solution {
  LmSummary summary;
  Se3 T;
  Matrix6 H;
};
// Solves with weights held at where the last one ended, until that does not matter.
inline Solution settle(const CostTerms& terms, const MotionReferences& references, RobustLoss loss,
                       const Se3& start) {
  LevenbergMarquardt<6> solver;
  Solution solution;
  solution.T = start;
  for (int solve = 0; solve < 4; ++solve) {
    MotionProblem problem(terms, references, {}, MotionProblem::make_kernels(terms, loss), solution.T);
    solution.summary = solver.solve(problem);
    solution.T = problem.T_current_reference();
  }
  solution.H = solver.hessian();
  return solution;
}

// Maximum likelihood over every match, from a start near the truth, without RANSAC.
inline LmSummary refine_all(Bench& bench, const SimulatedPair& pair, const Se3& start, RobustLoss loss,
                            Se3& T, Matrix6& H) {
  bench.points.clear();
  bench.lines.clear();
  bench.load(pair);
  for (ConstraintSet* set : bench.sets) flag_all(*set);
  const Solution solution = settle(CostTerms(bench.sets), MotionReferences{}, loss, start);
  T = solution.T;
  H = solution.H;
  return solution.summary;
}

inline double nees(const Se3& estimate, const Se3& truth, const Matrix6& information) {
  const Vector6 error = boxminus(truth, estimate);
  return error.dot(information * error);
}

}  // namespace plvo::test
