// SPDX-License-Identifier: Apache-2.0
// What the depths of points say about a motion: against a dense weighted least squares, its statistics, and a
// mirror.
#include "plvo/motion/depth_shift.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;
using test::SimulatedPair;

constexpr double kSmoothError_m = 0.001;

// All points as inliers of one set.
class DepthShiftTest : public testing::Test {
 protected:
  const PointConstraints& load(const SimulatedPair& pair, double correlation) {
    bench_.points.clear();
    bench_.lines.clear();
    bench_.load(pair);
    test::flag_all(bench_.points.back());
    bench_.points.back().set_reference(0, correlation);
    return bench_.points.back();
  }

 private:
  test::Bench bench_;
};

// The same with dense matrices over all residuals. The smooth error is that of a wall at the mean depth: an
// offset and two tilts.
DepthShift dense_shift(const SimulatedPair& pair, const Se3& T, double correlation, double smooth_m) {
  const auto n = static_cast<int>(pair.points_reference.size());
  Eigen::MatrixXd J(n, 3);
  Eigen::VectorXd e(n), weight(n);
  double depth = 0;
  for (int i = 0; i < n; ++i) {
    const Point3d& reference = pair.points_reference[static_cast<std::size_t>(i)];
    const Point3d& current = pair.points_current[static_cast<std::size_t>(i)];
    const Vector3 p = T * reference.p;
    J.row(i) << 1, p.y(), -p.x();
    e[i] = current.p.z() - p.z();
    const Matrix3 Sigma = T.R * reference.Sigma * T.R.transpose() + current.Sigma;
    weight[i] = 1 / Sigma(2, 2);
    depth += p.z() / n;
  }
  // n residuals weigh as much as n / (1 + (n − 1) ρ) independent ones.
  const Eigen::Matrix3d H = J.transpose() * weight.asDiagonal() * J / (1 + (n - 1) * correlation);
  const Eigen::Vector3d g = J.transpose() * weight.asDiagonal() * e / (1 + (n - 1) * correlation);
  const Eigen::Vector3d shift = H.inverse() * g;
  Eigen::Matrix3d C = H.inverse();
  const double sd[] = {smooth_m * depth * depth, smooth_m * depth, smooth_m * depth};
  for (int k = 0; k < 3; ++k) C(k, k) += sd[k] * sd[k];
  const double mean = weight.dot(e) / weight.sum();
  const double variance = (1 + (n - 1) * correlation) / weight.sum() + sd[0] * sd[0];
  return {T.t.z(), mean, 1 / variance, shift.dot(C.inverse() * shift)};
}

TEST_F(DepthShiftTest, IsTheDenseSolution) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Gaussian gaussian(seed);
    const SimulatedPair pair = test::simulate(gaussian, 40, 0);
    const Se3 T = boxplus(pair.truth, 0.01 * gaussian.vector<6>());
    for (const double correlation : {0.0, 0.1})
      for (const double smooth_m : {0.0, kSmoothError_m}) {
        const DepthShift expected = dense_shift(pair, T, correlation, smooth_m);
        const DepthShift found = depth_shift(load(pair, correlation), T, smooth_m);
        EXPECT_NEAR(found.z, expected.z, 1e-9);
        EXPECT_NEAR(found.information, expected.information, 1e-6 * expected.information);
        EXPECT_NEAR(found.chi_square, expected.chi_square, 1e-6 * expected.chi_square);
        EXPECT_EQ(found.t_z, T.t.z());
      }
  }
}

// At the true motion the shift is noise, with the variance that it states.
TEST_F(DepthShiftTest, IsNoiseInAWorldAtRest) {
  constexpr int kTrials = 600;
  double chi_square = 0, squares = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Gaussian gaussian(100 + static_cast<std::uint64_t>(trial));
    const SimulatedPair pair = test::simulate(gaussian, 60, 0);
    const DepthShift shift = depth_shift(load(pair, 0), pair.truth, 0);
    chi_square += shift.chi_square / kTrials;
    squares += shift.z * shift.z * shift.information / kTrials;
  }
  // Five SDs of these means: √(2 · 3 / 600) and √(2 / 600).
  EXPECT_NEAR(chi_square, 3, 0.5);
  EXPECT_NEAR(squares, 1, 0.3);
}

// A pane at 2 m; what is seen in it lies 0.8 m behind. The parallax is that of 5/7 of the motion.
TEST_F(DepthShiftTest, ShowsThatAMirrorIsSeen) {
  constexpr double kPane_m = 2, kBehind_m = 0.8, kMoved_m = 0.1;
  Gaussian gaussian(7);
  gaussian.set_silent(true);
  SimulatedPair pair;
  pair.truth = {Matrix3::Identity(), {0, 0, -kMoved_m}};
  for (int i = 0; i < 100; ++i) {
    const Vector3 ray(gaussian.uniform(-0.4, 0.4), gaussian.uniform(-0.3, 0.3), 1);
    const Vector3 seen = pair.truth * (ray * (kPane_m + kBehind_m));
    const Matrix3 S = test::kinect_covariance(kPane_m * ray);
    const auto id = static_cast<std::uint16_t>(i);
    pair.points_reference.push_back({kPane_m * ray, S});
    pair.points_current.push_back({seen / seen.z() * (kPane_m - kMoved_m), S});
    pair.point_matches.push_back({id, id});
  }
  const Se3 by_parallax{Matrix3::Identity(), kPane_m / (kPane_m + kBehind_m) * pair.truth.t};
  const DepthShift shift = depth_shift(load(pair, 0.1), by_parallax, kSmoothError_m);
  EXPECT_NEAR(shift.z, (pair.truth.t - by_parallax.t).z(), 1e-9);
  EXPECT_GT(shift.chi_square, 11.3);
  EXPECT_LT(depth_shift(load(pair, 0.1), pair.truth, kSmoothError_m).chi_square, 1e-9);
}

TEST_F(DepthShiftTest, IsNothingWithTooFewPoints) {
  Gaussian gaussian(3);
  for (const int points : {0, 1, 2}) {
    const SimulatedPair pair = test::simulate(gaussian, points, 0);
    const DepthShift shift = depth_shift(load(pair, 0), pair.truth, kSmoothError_m);
    EXPECT_EQ(shift.information, 0) << points;
    EXPECT_EQ(shift.chi_square, 0) << points;
  }
}

}  // namespace
}  // namespace plvo
