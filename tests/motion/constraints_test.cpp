// SPDX-License-Identifier: Apache-2.0
// The constraints against independent statements of themselves: the dense joint problem (13), (18), (22) with
// all its landmarks in one big matrix, built from (5) and (6) as they stand and from numerical derivatives.
#include <gtest/gtest.h>

#include <functional>

#include "motion_information.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Dense;
using test::DenseVector;
using test::Gaussian;
using test::SimulatedPair;

// (6) for both ends of a segment at once: the whitened residual of [A; B] against the line through p and q,
// each end free to slide along it. With B(λ) linear in the two λ this is a least-squares residual, (I − Q Qᵀ)
// L⁻¹ r.
Vector6 sliding_residual(const Line3d& measured, const Vector3& p, const Vector3& q) {
  const Dense L = test::cholesky(measured.Sigma);
  Dense D = Dense::Zero(6, 2);
  D.block<3, 1>(0, 0) = q - p;
  D.block<3, 1>(3, 1) = q - p;
  Vector6 r;
  r << measured.a - p, measured.b - p;
  const Dense D_white = test::solve_lower(L, D);
  const Dense r_white = test::solve_lower(L, r);
  const Dense slide = test::solve_positive(test::transposed_product(D_white, D_white),
                                           test::transposed_product(D_white, r_white));
  return r_white - test::product(D_white, slide);
}

// (6), one end with its own 3×3 covariance, straight from the formula of the paper.
Vector3 delta(const Vector3& P, const Matrix3& Sigma, const Vector3& A, const Vector3& B) {
  const Matrix3 W = Sigma.inverse();
  const Vector3 d = B - A;
  return P - (A - d * (d.dot(W * (A - P)) / d.dot(W * d)));
}

// The joint problem: parameters ξ (6), points (3 each), lines (two points of the landmark, the paper's [α;
// β], and the position along it of each of the four measured ends: 10 each). With these positions stated,
// every residual is plain measurement minus model, and no derivative of δ along the line can be mistaken for
// information.
struct JointProblem {
  const SimulatedPair& pair;
  Se3 T;
  std::vector<Vector3> points;
  std::vector<Vector6> lines;
  std::vector<Vector4> lambdas;  // positions of A, B, A', B' along their landmark, in units of β − α

  explicit JointProblem(const SimulatedPair& p, const Se3& start) : pair(p), T(start) {
    for (const Point3d& point : pair.points_reference) points.push_back(point.p);
    for (std::size_t i = 0; i < pair.lines_reference.size(); ++i) {
      const Line3d& line = pair.lines_reference[i];
      Vector6 landmark;
      landmark << line.a, line.b;
      lines.push_back(landmark);
      const Vector3 d = line.b - line.a;
      const Se3 back = T.inverse();
      const auto along = [&](const Vector3& x) { return d.dot(x - line.a) / d.squaredNorm(); };
      lambdas.push_back({0, 1, along(back * pair.lines_current[i].a), along(back * pair.lines_current[i].b)});
    }
  }
  Eigen::Index parameters() const {
    return 6 + 3 * static_cast<Eigen::Index>(points.size()) + 10 * static_cast<Eigen::Index>(lines.size());
  }
  void move(const DenseVector& step) {
    T = boxplus(T, step.head<6>());
    Eigen::Index k = 6;
    for (Vector3& point : points) point += step.segment<3>(k), k += 3;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      lines[i] += step.segment<6>(k), k += 6;
      lambdas[i] += step.segment<4>(k), k += 4;
    }
  }
  // Whitened residuals: both frames, measurement minus landmark.
  DenseVector residuals() const {
    DenseVector r(6 * static_cast<Eigen::Index>(points.size()) +
                  12 * static_cast<Eigen::Index>(lines.size()));
    Eigen::Index k = 0;
    const auto add3 = [&](const Matrix3& Sigma, const Vector3& v) {
      r.segment<3>(k) = test::solve_lower(test::cholesky(Sigma), v);
      k += 3;
    };
    const auto add6 = [&](const Matrix6& Sigma, const Vector3& a, const Vector3& b) {
      Vector6 v;
      v << a, b;
      r.segment<6>(k) = test::solve_lower(test::cholesky(Sigma), v);
      k += 6;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
      add3(pair.points_reference[i].Sigma, pair.points_reference[i].p - points[i]);
      add3(pair.points_current[i].Sigma, pair.points_current[i].p - T * points[i]);
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Vector3 alpha = lines[i].head<3>();
      const Vector3 d = lines[i].tail<3>() - alpha;
      const Vector4& s = lambdas[i];
      const Line3d& first = pair.lines_reference[i];
      const Line3d& second = pair.lines_current[i];
      add6(first.Sigma, first.a - (alpha + s[0] * d), first.b - (alpha + s[1] * d));
      add6(second.Sigma, second.a - T * Vector3(alpha + s[2] * d), second.b - T * Vector3(alpha + s[3] * d));
    }
    return r;
  }
  Dense jacobian() const {
    const Eigen::Index n = parameters();
    Dense J(residuals().size(), n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double h = 1e-6;
      JointProblem plus = *this, minus = *this;
      plus.move(h * DenseVector::Unit(n, j));
      minus.move(-h * DenseVector::Unit(n, j));
      J.col(j) = (plus.residuals() - minus.residuals()) / (2 * h);
    }
    return J;
  }
  // JᵀJ, made regular by forbidding every landmark's two points to slide along their line: a gauge of its
  // own, unlike that of the eliminated solver, and of any weight.
  Dense normal_matrix(const Dense& J, double gauge_weight) const {
    Dense N = test::transposed_product(J, J);
    Eigen::Index k = 6 + 3 * static_cast<Eigen::Index>(points.size());
    for (const Vector6& landmark : lines) {
      const Vector3 d = (landmark.tail<3>() - landmark.head<3>()).normalized();
      N.block<3, 3>(k, k) += gauge_weight * d * d.transpose();
      N.block<3, 3>(k + 3, k + 3) += gauge_weight * d * d.transpose();
      k += 10;
    }
    return N;
  }
  void solve() {
    for (int iteration = 0; iteration < 8; ++iteration) {
      const Dense J = jacobian();
      move(-test::solve_positive(normal_matrix(J, 1e6), test::transposed_product(J, residuals())));
    }
  }
  // Covariance of ξ: the 6×6 corner of the inverse, where the gauge must not show.
  Matrix6 covariance(double gauge_weight) const {
    const Dense J = jacobian();
    return test::inverse(normal_matrix(J, gauge_weight)).topLeftCorner<6, 6>();
  }
};

class Joint : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(Joint, EliminationEqualsTheDenseSolve) {
  const auto [n, m] = GetParam();
  Gaussian gaussian(31);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, n, m);
  Se3 T;
  Matrix6 H;
  ASSERT_TRUE(converged(test::refine_all(bench, pair, Se3{}, RobustLoss::kNone, T, H).status));

  JointProblem joint(pair, pair.truth);
  joint.solve();
  const Matrix6 C = joint.covariance(1e6);
  EXPECT_LT((joint.covariance(1e3) - C).norm(), 1e-5 * C.norm()) << "the gauge shows";
  const Matrix6 C_eliminated = test::inverse(H);
  const Vector6 difference = boxminus(T, joint.T);
  for (int i = 0; i < 6; ++i) {
    const double sigma = std::sqrt(C(i, i));
    EXPECT_NEAR(difference[i] / sigma, 0, 3e-3) << "ξ[" << i << "], in SDs";
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(C_eliminated(i, j) / (sigma * std::sqrt(C(j, j))), C(i, j) / (sigma * std::sqrt(C(j, j))),
                  1e-3);
  }
}
INSTANTIATE_TEST_SUITE_P(Kinds, Joint, ::testing::Values(std::pair{12, 0}, std::pair{0, 8}, std::pair{8, 6}));

TEST(LineResidual, BothEndsAtOnceIsTheDeltaOfThePaperWhenTheEndsAreUncorrelated) {
  Gaussian gaussian(32);
  SimulatedPair pair = test::simulate(gaussian, 0, 5);
  for (const Line3d& measured : pair.lines_reference) {
    Line3d line = measured;
    line.Sigma.block<3, 3>(0, 3).setZero();
    line.Sigma.block<3, 3>(3, 0).setZero();
    const Vector3 p = line.a + 0.02 * gaussian.vector<3>();
    const Vector3 q = line.b + 0.02 * gaussian.vector<3>();
    const Matrix3 S_a = line.Sigma.block<3, 3>(0, 0);
    const Matrix3 S_b = line.Sigma.block<3, 3>(3, 3);
    const Vector3 at_a = delta(line.a, S_a, p, q);
    const Vector3 at_b = delta(line.b, S_b, p, q);
    const double paper = at_a.dot(S_a.inverse() * at_a) + at_b.dot(S_b.inverse() * at_b);  // (7), squared
    EXPECT_NEAR(sliding_residual(line, p, q).squaredNorm(), paper, 1e-9 * (1 + paper));
  }
}

// mahalanobis_squared holds the landmark at the reference measurement; a landmark free to move must give the
// same but for terms of second order in the noise.
TEST(LineResidual, MahalanobisDistanceIsThatOfTheBestLandmark) {
  Gaussian gaussian(33);
  Bench bench;
  for (int trial = 0; trial < 20; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 0, 1);
    bench.lines.clear();
    bench.points.clear();
    bench.load(pair);
    test::flag_all(bench.lines[0]);
    bench.lines[0].begin(pair.truth, {}, RobustKernel(), 1);
    JointInformation sum;
    const double cost = bench.lines[0].linearize(pair.truth, {}, RobustKernel(RobustLoss::kNone, 4), sum);
    const double s = bench.lines[0].mahalanobis_squared(0, pair.truth, 1e9);
    EXPECT_NEAR(2 * cost, s, 0.15 * s + 0.05);
  }
}

// The squared distance of the offsets of both ends from the reference line, written out with whole matrices.
double distance_of_offsets(const Line3d& reference, const Line3d& current, const Se3& T) {
  const Vector3 q = 0.5 * (reference.a + reference.b);
  const double half = 0.5 * (reference.b - reference.a).norm();
  const Matrix3 G = frame_along((reference.b - reference.a) / (2 * half));
  Dense across = Dense::Zero(6, 4);
  across.block<3, 2>(0, 0) = across.block<3, 2>(3, 2) = G.leftCols<2>();
  Dense turned = Dense::Zero(6, 4);
  turned.block<3, 2>(0, 0) = turned.block<3, 2>(3, 2) = T.R * G.leftCols<2>();
  DenseVector offsets(6);
  offsets << current.a - T * q, current.b - T * q;
  const auto share = [&](const Vector3& end) {
    return (half + (T.R * G.col(2)).dot(end - T * q)) / (2 * half);
  };
  Dense N = Dense::Zero(4, 4);
  for (int k = 0; k < 2; ++k) {
    N(k, k) = 1 - share(current.a);
    N(k, 2 + k) = share(current.a);
    N(2 + k, k) = 1 - share(current.b);
    N(2 + k, 2 + k) = share(current.b);
  }
  const Dense C_reference = test::transposed_product(across, test::product(reference.Sigma, across));
  const Dense C_current = test::transposed_product(turned, test::product(current.Sigma, turned));
  const Dense C = C_current + test::product(N, test::product(C_reference, N.transpose()));
  const DenseVector e = test::transposed_product(turned, offsets);
  return test::solve_lower(test::cholesky(C), e).squaredNorm();
}

// Bounds by the trace and by each end may end the evaluation early; they must never reject a line within the
// cutoff, nor change a distance that is within it.
TEST(LineResidual, EarlyBoundsRejectOnlyBeyondTheCutoff) {
  Gaussian gaussian(35);
  Bench bench;
  int within = 0, beyond = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 0, 1);
    bench.lines.clear();
    bench.points.clear();
    bench.load(pair);
    Vector6 step;
    for (int k = 0; k < 6; ++k) step[k] = (trial % 4) * (k < 3 ? 0.005 : 0.002) * gaussian();
    const Se3 T = boxplus(pair.truth, step);
    const double reference = distance_of_offsets(pair.lines_reference[0], pair.lines_current[0], T);
    const double whole = bench.lines[0].mahalanobis_squared(0, T, 1e12);
    EXPECT_NEAR(whole, reference, 1e-8 * (1 + reference));
    for (const double cutoff : {1.0, 6.0, 13.3, 53.0, 400.0}) {
      const double s = bench.lines[0].mahalanobis_squared(0, T, cutoff);
      if (whole <= cutoff) {
        EXPECT_EQ(s, whole);
        ++within;
      } else {
        EXPECT_GT(s, cutoff);
        EXPECT_LE(s, std::max(2 * cutoff, whole * (1 + 1e-9)));
        ++beyond;
      }
    }
  }
  EXPECT_GT(within, 200);
  EXPECT_GT(beyond, 200);
}

// Gradient of the eliminated cost against central differences of it; for every kind and every loss.
class Gradient : public ::testing::TestWithParam<std::tuple<int, RobustLoss>> {};

TEST_P(Gradient, IsThatOfTheEliminatedCost) {
  const auto [kind, loss] = GetParam();
  Gaussian gaussian(34);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, kind == 0 ? 10 : 0, kind == 1 ? 10 : 0);
  bench.load(pair);
  ConstraintSet& set = *bench.sets[static_cast<std::size_t>(kind)];
  test::flag_all(set);
  const RobustKernel kernel(loss, set.dof());
  Vector6 offset;
  offset << 0.006, -0.003, 0.009, 0.0015, 0.0024, -0.0015;  // far enough for the losses to bend
  const Se3 T = boxplus(pair.truth, offset);
  set.begin(T, {}, RobustKernel(), 1);
  const auto evaluate = [&](const Se3& at, Vector6& g) {
    JointInformation sum;
    const double cost = set.linearize(at, {}, kernel, sum);
    g = sum.g.head<6>();
    return cost;
  };
  Vector6 g, unused;
  (void)evaluate(T, g);
  for (int j = 0; j < 6; ++j) {
    const double h = 1e-5;
    const double numeric = (evaluate(boxplus(T, h * Vector6::Unit(j)), unused) -
                            evaluate(boxplus(T, -h * Vector6::Unit(j)), unused)) /
                           (2 * h);
    EXPECT_NEAR(g[j], numeric, 1e-5 * g.norm()) << j;
  }
}
INSTANTIATE_TEST_SUITE_P(KindsAndLosses, Gradient,
                         ::testing::Combine(::testing::Values(0, 1),
                                            ::testing::Values(RobustLoss::kNone, RobustLoss::kHuber)));

// The gauge: which end is called A, in either frame, how long the measured stretch of the landmark is stated
// to be, and a common rotation of the reference axes (which turns the basis across every line) must not show
// in C_L.
TEST(Gauge, DoesNotChangeTheCovariance) {
  Gaussian gaussian(35);
  Bench bench;
  const SimulatedPair pair = test::simulate(gaussian, 0, 12);
  Se3 T, T_flipped, T_turned;
  Matrix6 H, H_flipped, H_turned;
  (void)test::refine_all(bench, pair, Se3{}, RobustLoss::kNone, T, H);

  SimulatedPair flipped = pair;
  for (std::size_t i = 0; i < pair.lines_reference.size(); ++i)
    for (Line3d* line : {&flipped.lines_reference[i], &flipped.lines_current[i]}) {
      if (gaussian.random().below(2) == 0) continue;
      std::swap(line->a, line->b);
      Matrix6 swapped;
      swapped << line->Sigma.block<3, 3>(3, 3), line->Sigma.block<3, 3>(3, 0), line->Sigma.block<3, 3>(0, 3),
          line->Sigma.block<3, 3>(0, 0);
      line->Sigma = swapped;
    }
  (void)test::refine_all(bench, flipped, Se3{}, RobustLoss::kNone, T_flipped, H_flipped);
  EXPECT_LT((H_flipped - H).norm(), 1e-5 * H.norm());
  EXPECT_LT(boxminus(T_flipped, T).norm(), 1e-8);

  // Reference coordinates turned by Q: T becomes T Q⁻¹, and ⊞ acts on the left, so H stays.
  SimulatedPair turned = pair;
  const Matrix3 Q = rotation_exp({0.4, -0.9, 1.3});
  Matrix6 QQ = Matrix6::Zero();
  QQ.block<3, 3>(0, 0) = Q;
  QQ.block<3, 3>(3, 3) = Q;
  for (Line3d& line : turned.lines_reference) {
    line.a = Q * line.a;
    line.b = Q * line.b;
    line.Sigma = (QQ * line.Sigma * QQ.transpose()).eval();
  }
  (void)test::refine_all(bench, turned, Se3{Q.transpose(), Vector3::Zero()}, RobustLoss::kNone, T_turned,
                         H_turned);
  EXPECT_LT((H_turned - H).norm(), 1e-4 * H.norm());  // the landmarks' tolerance
}

// Theorem 1: (26), and (25) for every ordered eigenvalue.
TEST(Theorem1, FusionBeatsEitherKind) {
  Gaussian gaussian(36);
  Bench bench;
  for (int trial = 0; trial < 20; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 30, 12);
    MotionStart start = nullptr;
    start.search_beside = false;  // C_H then contains no other motion
    start.find_shifts = false;    // leaves the terms as C_H was computed from them
    // The last step, after which H is not computed again, must not matter.
    const MotionEstimate estimate =
        bench.estimate(pair, {}, 1, start, {.max_iterations = 40, .step_tolerance = 1e-10});
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    const Matrix6 I_P = test::information_of(*bench.sets[0], estimate.T_current_reference);
    const Matrix6 I_L = test::information_of(*bench.sets[1], estimate.T_current_reference);
    EXPECT_LT((estimate.C_H * (I_P + I_L) - Matrix6::Identity()).norm(), 1e-6);
    const DenseVector H = test::symmetric_eigenvalues(estimate.C_H);
    const DenseVector P = test::symmetric_eigenvalues(test::inverse(I_P));
    const DenseVector L = test::symmetric_eigenvalues(test::inverse(I_L));
    for (int i = 0; i < 6; ++i) {
      EXPECT_LT(H[i], P[i]);
      EXPECT_LT(H[i], L[i]);
    }
  }
}

}  // namespace
}  // namespace plvo
