// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/statistics.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

#include "plvo/eval/alignment.hpp"

namespace plvo::eval {
namespace {

TEST(Statistics, AgreeWithAKnownList) {
  const Statistics s = statistics({4, 1, 3, 2});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(30.0 / 4));
  EXPECT_DOUBLE_EQ(s.p90, 3.7);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_EQ(statistics({}).count, 0u);
  EXPECT_EQ(statistics({}).rmse, 0);
}

TEST(Alignment, RecoversARigidMotion) {
  const Se3 T{rotation_exp(Vector3(0.3, -1.2, 2.0)), Vector3(1, -2, 3)};
  const std::vector<Vector3> from = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0.5, 0.1, 3}};
  std::vector<Vector3> to;
  for (const Vector3& p : from) to.push_back(T * p);
  const Se3 found = align(from, to);
  EXPECT_LT((found.R - T.R).norm(), 1e-12);
  EXPECT_LT((found.t - T.t).norm(), 1e-12);
}

TEST(Alignment, NeverReflects) {
  // A planar point set and its reflection: the result must be the best rotation, not the better reflection.
  const std::vector<Vector3> from = {{1, 0, 0.1}, {0, 1, -0.1}, {-1, 0, 0.1}, {0, -1, -0.1}};
  std::vector<Vector3> to;
  for (const Vector3& p : from) to.emplace_back(p.x(), p.y(), -p.z());
  EXPECT_NEAR(align(from, to).R.determinant(), 1, 1e-12);
}

TEST(Alignment, PerfectEstimateInAnotherWorldHasNoError) {
  std::vector<Se3> truth, estimate;
  const Se3 other{rotation_exp(Vector3(0.1, 0.2, 0.3)), Vector3(5, 6, 7)};
  for (int i = 0; i < 10; ++i) {
    truth.push_back({rotation_exp(Vector3(0, 0.1 * i, 0)), Vector3(0.1 * i, 0.01 * i * i, std::sin(i))});
    estimate.push_back(other * truth.back());
  }
  EXPECT_LT(absolute_trajectory_error(estimate, truth).position_m.max, 1e-12);
  EXPECT_GT(identity_absolute_error(truth).rmse, 0.1);
}

}  // namespace
}  // namespace plvo::eval
