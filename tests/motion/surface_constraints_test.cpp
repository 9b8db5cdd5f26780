// SPDX-License-Identifier: Apache-2.0
// Samples of surfaces as constraints: derivatives against differences of the cost, the elimination of what
// they share against a dense system, the covariance against what noise does; and that a corridor's walls say
// nothing along the corridor.
#include "plvo/motion/surface_constraints.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Dense;
using test::DenseVector;
using test::Gaussian;

constexpr int kJoint = JointInformation::kSize;

// Walls seen in two frames. Each sample is off by noise along the normal, the normals by noise of their own;
// all of the current frame by what they share.
struct Walls {
  std::vector<SurfaceMatch> matches;
  Se3 truth;

  // faces: unit normals. γ: of the errors that the matches share.
  Walls(Gaussian& gaussian, const std::vector<Vector3>& faces, int n, double sigma, double normal_sigma,
        const Vector2& gamma = Vector2::Zero()) {
    truth = test::random_motion(gaussian);
    for (int i = 0; i < n; ++i) {
      const Vector3 face = faces[static_cast<std::size_t>(i) % faces.size()];
      const Vector3 p = test::random_point(gaussian);
      const Vector3 n_current = truth.R * face;
      SurfaceMatch match;
      match.variance = sigma * sigma;
      match.normal_variance = normal_sigma * normal_sigma;
      match.p_reference = p;
      // Where the current frame sees the surface depends on the noise too: somewhere near on the plane.
      Vector3 along = 0.01 * gaussian.vector<3>();
      along -= n_current.dot(along) * n_current;
      match.p_current = truth * p + along + sigma * gaussian() * n_current;
      match.common.col(0) = 0.001 * Vector3(1, -0.5, 0.3) + 0.001 * Vector3(0.2, 1, 0).cross(p);
      match.common.col(1) = 0.0004 * p.z() * p;
      match.p_current += match.common * gamma;
      Vector3 off = normal_sigma * gaussian.vector<3>();
      off -= face.dot(off) * face;
      match.normal = (truth.R * (face + off)).normalized();
      matches.push_back(match);
    }
  }
};

std::vector<Vector3> room() { return {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}}; }

struct SurfaceSet {
  explicit SurfaceSet(const Walls& walls)
      : flags(walls.matches.size()), constraints(walls.matches, {flags, {&form, 1}}), terms{&constraints} {}
  std::vector<std::uint8_t> flags;
  SurfaceForm form;
  SurfaceConstraints constraints;
  std::vector<CostTerm*> terms;
};

const RobustKernel kKernel(RobustLoss::kHuber, 1);

NuisanceParameters room_errors() {
  CameraModel camera;
  camera.readout_s = 0.03;
  return {Exposure(camera, Vector6::Zero(), 0), 0.3, 0.004};
}

TEST(SurfaceConstraints, TheGradientIsThatOfTheCost) {
  Gaussian gaussian(11);
  Walls walls(gaussian, room(), 30, 0.004, 0.03);
  for (SurfaceMatch& match : walls.matches) match.delay_s = gaussian.uniform(-0.02, 0.02);
  NuisanceParameters at = room_errors();
  for (int k = 0; k < NuisanceParameters::kCount; ++k) at.value[k] = 0.2 * at.sigma(k) * gaussian();
  SurfaceSet set(walls);
  const Se3 T = boxplus(walls.truth, 1e-3 * gaussian.vector<6>());
  set.constraints.begin(T, at, kKernel, 1);
  JointInformation sum;
  (void)set.constraints.linearize(T, at, kKernel, sum);
  EXPECT_EQ(sum.H, sum.H.transpose());
  const auto cost = [&](int k, double step) {
    Vector6 delta = Vector6::Zero();
    NuisanceParameters shared = at;
    if (k < 6)
      delta[k] = step;
    else
      shared.value[k - 6] += step;
    JointInformation unused;
    return set.constraints.linearize(boxplus(T, delta), shared, kKernel, unused);
  };
  for (int k = 0; k < kJoint; ++k) {
    const double h = 1e-5;
    const double numeric = (cost(k, h) - cost(k, -h)) / (2 * h);
    EXPECT_NEAR(sum.g[k], numeric, 1e-5 * (sum.H(k, k) * 1e-3 + std::abs(numeric))) << k;
  }
}

TEST(SurfaceConstraints, AStrideOfFourEqualsASetOfEveryFourthMatch) {
  Gaussian gaussian(21);
  const Walls walls(gaussian, room(), 40, 0.004, 0.03);
  Walls fewer = walls;
  fewer.matches.clear();
  for (std::size_t i = 0; i < walls.matches.size(); i += 4) fewer.matches.push_back(walls.matches[i]);
  const Se3 T = boxplus(walls.truth, 1e-3 * gaussian.vector<6>());
  SurfaceSet some(walls), all(fewer);
  some.flags.assign(some.flags.size(), 1);
  some.constraints.begin(T, {}, kKernel, 4);
  all.constraints.begin(T, {}, kKernel, 1);
  for (std::size_t i = 0; i < some.flags.size(); ++i)
    EXPECT_EQ(some.flags[i], i % 4 == 0 ? all.flags[i / 4] : 0) << i;
  JointInformation sum, expected;
  EXPECT_EQ(some.constraints.linearize(T, {}, kKernel, sum),
            all.constraints.linearize(T, {}, kKernel, expected));
  EXPECT_EQ(sum.H, expected.H);
  EXPECT_EQ(sum.g, expected.g);
}

// The slow, obvious statement: all parameters in one dense system, match by match, those of the set last.
TEST(SurfaceConstraints, EliminationOfCommonErrorsEqualsADenseSystem) {
  Gaussian gaussian(12);
  Walls walls(gaussian, room(), 40, 0.004, 0.02, {1.2, -0.7});
  for (SurfaceMatch& match : walls.matches) match.delay_s = gaussian.uniform(-0.02, 0.02);
  NuisanceParameters shared = room_errors();
  SurfaceSet set(walls);
  set.constraints.begin(walls.truth, shared, kKernel, 1);
  // Some steps of a solve later.
  const Se3 T = boxplus(walls.truth, 3e-3 * gaussian.vector<6>());
  for (int k = 0; k < NuisanceParameters::kCount; ++k) shared.value[k] = 0.2 * shared.sigma(k) * gaussian();
  JointInformation sum;
  const double cost = set.constraints.linearize(T, shared, kKernel, sum);

  constexpr int kAll = kJoint + 2;
  Dense H = Dense::Zero(kAll, kAll);
  H(kJoint, kJoint) = H(kJoint + 1, kJoint + 1) = 1;
  DenseVector g = DenseVector::Zero(kAll);
  double plain = 0;
  int inliers = 0;
  for (std::size_t i = 0; i < walls.matches.size(); ++i) {
    if (set.flags[i] == 0) continue;
    ++inliers;
    const SurfaceMatch& match = walls.matches[i];
    const Dense F = shared.field(match.p_current, match.delay_s).matrix();
    Dense V(3, kAll);
    V << Dense::Identity(3, 3), -Dense(skew(T.R * match.p_reference)), F, Dense(match.common);
    const DenseVector n = match.normal;
    // The weights are those at the start of the solve, without nuisance parameters.
    double weight = 1;
    (void)kKernel(set.constraints.mahalanobis_squared(i, walls.truth), weight);
    const Dense M =
        weight *
        ((1 + match.normal_variance) * n * n.transpose() - match.normal_variance * Dense::Identity(3, 3)) /
        match.variance;
    const DenseVector e =
        T * match.p_reference - match.p_current + shared.field(match.p_current, match.delay_s) * shared.value;
    H += V.transpose() * M * V;
    g += V.transpose() * M * e;
    plain += 0.5 * e.dot(M * e);
  }
  EXPECT_GT(inliers, 30);
  const Dense gain = H.block(0, kJoint, kJoint, 2) * test::inverse(H.bottomRightCorner(2, 2));
  const Dense expected = H.topLeftCorner(kJoint, kJoint) - gain * H.block(kJoint, 0, 2, kJoint);
  const DenseVector expected_g = g.head(kJoint) - gain * g.tail(2);
  const double expected_cost =
      plain - 0.5 * g.tail(2).dot(test::inverse(H.bottomRightCorner(2, 2)) * g.tail(2));
  EXPECT_LT((Dense(sum.H) - expected).norm(), 1e-9 * expected.norm());
  EXPECT_LT((DenseVector(sum.g) - expected_g).norm(), 1e-9 * expected_g.norm());
  EXPECT_NEAR(cost, expected_cost, 1e-9 * plain);
}

TEST(SurfaceConstraints, TheCovarianceMatchesTheErrors) {
  Gaussian gaussian(13);
  constexpr int kTrials = 300;
  double nees = 0;
  double nees_without = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector2 gamma(gaussian(), gaussian());
    Walls walls(gaussian, room(), 150, 0.004, 0.01, gamma);
    const auto nees_of = [&] {
      SurfaceSet set(walls);
      const test::Solution solution =
          test::settle(CostTerms({}, set.terms), {}, RobustLoss::kNone, walls.truth);
      return test::nees(solution.T, walls.truth, solution.H) / kTrials;
    };
    nees += nees_of();
    for (SurfaceMatch& match : walls.matches) match.common.setZero();
    nees_without += nees_of();
  }
  EXPECT_GT(nees, 5);
  EXPECT_LT(nees, 7.5);
  EXPECT_GT(nees_without, 3 * nees) << "errors in common must matter here";
}

// Walls, floor and ceiling of a corridor along z; the normals are off by two degrees, as those of small
// windows are.
TEST(SurfaceConstraints, ACorridorsWallsDoNotConstrainMotionAlongIt) {
  Gaussian gaussian(14);
  constexpr int kTrials = 100;
  double along = 0;
  double naive = 0;
  double across = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Walls walls(gaussian, {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}}, 200, 0.005, 0.035);
    for (SurfaceMatch& match : walls.matches) match.common.setZero();
    const Vector3 axis = walls.truth.R.col(2);
    const auto information = [&](const Vector3& direction) {
      SurfaceSet set(walls);
      set.constraints.begin(walls.truth, {}, kKernel, 1);
      JointInformation sum;
      (void)set.constraints.linearize(walls.truth, {}, RobustKernel(), sum);
      const Matrix3 H = sum.H.block<3, 3>(0, 0);
      return direction.dot(H * direction) / kTrials;
    };
    along += information(axis);
    across += information(walls.truth.R.col(0));
    for (SurfaceMatch& match : walls.matches) match.normal_variance = 0;
    naive += information(axis);
  }
  // Noise of normals alone would hold the camera to 10 mm along the corridor.
  EXPECT_GT(naive, 8e3);
  EXPECT_LT(std::abs(along), 0.03 * naive);
  EXPECT_GT(across, 3e6);
}

TEST(SurfaceConstraints, SelectsItsOwnInliersOutsideOfRansac) {
  Gaussian gaussian(15);
  Walls walls(gaussian, room(), 50, 0.004, 0.01);
  walls.matches[3].p_current += 0.1 * walls.matches[3].normal;
  SurfaceSet set(walls);
  set.constraints.begin(walls.truth, {}, kKernel, 1);
  for (std::size_t i = 0; i < walls.matches.size(); ++i) EXPECT_EQ(set.flags[i], i == 3 ? 0 : 1) << i;

  // Surfaces alone fix this motion, but nothing tells that it is the right one.
  std::vector<std::byte> memory(1 << 20);
  Arena arena(memory);
  const MotionEstimate estimate = estimate_motion({}, set.terms, {}, {}, {}, 1, {&walls.truth}, arena);
  EXPECT_EQ(estimate.status, StatusCode::kTooFewFeatures);
}

// Few points and lines leave a bare room's motion vague; its surfaces make it sharper, and the covariance
// stays true.
TEST(SurfaceConstraints, JoinPointsAndLines) {
  Gaussian gaussian(16);
  constexpr int kTrials = 150;
  double error_with = 0;
  double error_without = 0;
  double nees = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Walls walls(gaussian, room(), 150, 0.003, 0.01, {gaussian(), gaussian()});
    test::SimulatedPair pair;
    pair.truth = walls.truth;
    for (int i = 0; i < 20; ++i) pair.add_point(gaussian, test::random_point(gaussian));
    test::Bench bench;
    bench.load(pair);
    SurfaceSet set(walls);
    const auto estimate = [&](bool with) {
      const std::span<CostTerm* const> others = with ? set.terms : std::span<CostTerm* const>();
      const MotionEstimate result =
          estimate_motion(bench.sets, others, {}, {}, {}, 1, {&pair.truth}, bench.arena);
      EXPECT_EQ(result.status, StatusCode::kOk);
      return result;
    };
    const auto squared = [&](const MotionEstimate& result) {
      return boxminus(result.T_current_reference, pair.truth).head<3>().squaredNorm() / kTrials;
    };
    error_without += squared(estimate(false));
    const MotionEstimate with = estimate(true);
    error_with += squared(with);
    nees += test::nees(with.T_current_reference, pair.truth, test::inverse(with.C_H)) / kTrials;
  }
  EXPECT_LT(error_with, 0.5 * error_without);
  EXPECT_GT(nees, 4.5);
  EXPECT_LT(nees, 8.5);
}

}  // namespace
}  // namespace plvo
