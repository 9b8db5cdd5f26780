// SPDX-License-Identifier: Apache-2.0
// Each of the four minimal sets alone: exact on exact data, right within the noise on noisy data, and silent
// on sets that cannot fix a motion or that no rigid motion explains.
#include "plvo/motion/minimal_set.hpp"

#include <gtest/gtest.h>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;
using Set = std::array<Primitive, 3>;

constexpr double kSigmaM = 0.002;
constexpr double kSigmaRad = 0.005;

Primitive point(const Se3& T, const Vector3& p) {
  Primitive primitive;
  primitive.shape = Primitive::Shape::kPoint;
  primitive.p_reference = p;
  primitive.p_current = T * p;
  primitive.sigma_p_m = kSigmaM;
  return primitive;
}

// sign: the current frame may see the line run the other way; shift: and another stretch of it.
Primitive line(const Se3& T, const Vector3& p, const Vector3& direction, double sign = 1, double shift = 0) {
  Primitive primitive;
  const Vector3 d = direction.normalized();
  primitive.shape = Primitive::Shape::kLine;
  primitive.p_reference = p;
  primitive.d_reference = d;
  primitive.p_current = T * Vector3(p + shift * d);
  primitive.d_current = sign * (T.R * d);
  primitive.sigma_p_m = kSigmaM;
  primitive.sigma_d_rad = kSigmaRad;
  return primitive;
}

class Kinds : public ::testing::TestWithParam<int> {};

TEST_P(Kinds, ExactDataGiveTheExactMotion) {
  const int points = GetParam();
  Gaussian gaussian(51);
  int solved = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Se3 truth = test::random_motion(gaussian);
    Set set;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 p = test::random_point(gaussian);
      set[i] = static_cast<int>(i) < points
                   ? point(truth, p)
                   : line(truth, p, test::random_direction(gaussian),
                          gaussian.random().below(2) == 0 ? 1 : -1, gaussian.uniform(-0.3, 0.3));
    }
    std::swap(set[0], set[gaussian.random().below(3)]);
    Se3 T;
    if (solve_minimal_set(set, Matrix3::Identity(), T) != MinimalSetStatus::kSolved) continue;
    ++solved;
    EXPECT_LT(boxminus(T, truth).norm(), 1e-8);
  }
  EXPECT_GT(solved, 80);
}

TEST_P(Kinds, AcceptsNoisyData) {
  const int points = GetParam();
  Gaussian gaussian(52);
  Bench bench;
  int inconsistent = 0;
  int close = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, points, 3 - points);
    bench.points.clear();
    bench.lines.clear();
    bench.load(pair);
    Set set;
    std::size_t k = 0;
    for (const ConstraintSet* kind : bench.sets)
      for (std::size_t i = 0; i < kind->size(); ++i) set[k++] = kind->primitive(i);
    Se3 T;
    const MinimalSetStatus status = solve_minimal_set(set, Matrix3::Identity(), T);
    inconsistent += status == MinimalSetStatus::kInconsistent ? 1 : 0;
    close += status == MinimalSetStatus::kSolved && boxminus(T, pair.truth).tail<3>().norm() < 0.15 ? 1 : 0;
  }
  EXPECT_LT(inconsistent, 0.05 * 300);
  EXPECT_GT(close, 0.75 * 300);
}
INSTANTIATE_TEST_SUITE_P(Points, Kinds, ::testing::Values(0, 1, 2, 3));

TEST(MinimalSet, DegenerateSetsAreRejected) {
  Gaussian gaussian(53);
  const Se3 T = test::random_motion(gaussian);
  const Vector3 p(0.1, 0.2, 2), d(1, 0.5, 0.2), up(0, 1, 0);
  Se3 unused;
  const auto status = [&](const Set& set) { return solve_minimal_set(set, Matrix3::Identity(), unused); };
  // Three points on a line, or within a sigma of one.
  EXPECT_EQ(status({point(T, p), point(T, p + d), point(T, p + 2 * d)}), MinimalSetStatus::kDegenerate);
  EXPECT_EQ(status({point(T, p), point(T, p + d + kSigmaM * up), point(T, p + 2 * d)}),
            MinimalSetStatus::kDegenerate);
  EXPECT_EQ(status({point(T, p), point(T, p), point(T, p + d)}), MinimalSetStatus::kDegenerate);
  // Three parallel lines.
  EXPECT_EQ(status({line(T, p, d), line(T, p + up, d), line(T, p + Vector3(0, 0, 1), d)}),
            MinimalSetStatus::kDegenerate);
  // A point on the line, and on both lines.
  EXPECT_EQ(status({point(T, p), point(T, p + d), line(T, p + 3 * d, d)}), MinimalSetStatus::kDegenerate);
  EXPECT_EQ(status({point(T, p), line(T, p, d), line(T, p + up, up)}), MinimalSetStatus::kDegenerate);
  // A point in the plane of two parallel lines.
  EXPECT_EQ(status({point(T, p), line(T, p + up, d), line(T, p - up, d)}), MinimalSetStatus::kDegenerate);
  // Out of that plane it is a good set.
  EXPECT_EQ(status({point(T, p + Vector3(0, 0, 0.5)), line(T, p + up, d), line(T, p - up, d)}),
            MinimalSetStatus::kSolved);
}

TEST(MinimalSet, RejectsSetsWithoutARigidMotion) {
  Gaussian gaussian(54);
  const Se3 T = test::random_motion(gaussian);
  const Vector3 p(0.1, 0.2, 2), right(1, 0, 0), up(0, 1, 0), ahead(0, 0, 1);
  Se3 unused;
  Set points{point(T, p), point(T, p + right), point(T, p + up)};
  points[2].p_current += Vector3(0.05, 0.05, 0.05);
  EXPECT_EQ(solve_minimal_set(points, Matrix3::Identity(), unused), MinimalSetStatus::kInconsistent);
  Set lines{line(T, p, right), line(T, p + up, up), line(T, p + ahead, right + up)};
  lines[2].d_current = (T.R * Vector3(right + 2 * up)).normalized();
  EXPECT_EQ(solve_minimal_set(lines, Matrix3::Identity(), unused), MinimalSetStatus::kInconsistent);
}

TEST(MinimalSet, PerpendicularLinesTakeTheExpectedRotation) {
  // A room's corner: three lines through one point fit four rotations equally well.
  const Vector3 corner(0, 0, 3);
  const Se3 truth = {rotation_exp({0.1, -0.2, 0.05}), {0.1, 0, 0.05}};
  const Set set{line(truth, corner, {1, 0, 0}, -1), line(truth, corner, {0, 1, 0}),
                line(truth, corner, {0, 0, 1}, -1)};
  Se3 T;
  ASSERT_EQ(solve_minimal_set(set, Matrix3::Identity(), T), MinimalSetStatus::kSolved);
  EXPECT_LT(boxminus(T, truth).norm(), 1e-9);
  const Se3 turned = {rotation_exp({0, 3.1, 0}), {0.1, 0, 0.05}};
  const Set half_turn{line(turned, corner, {1, 0, 0}), line(turned, corner, {0, 1, 0}),
                      line(turned, corner, {0, 0, 1})};
  ASSERT_EQ(solve_minimal_set(half_turn, turned.R, T), MinimalSetStatus::kSolved);
  EXPECT_LT(boxminus(T, turned).norm(), 1e-9);
}

}  // namespace
}  // namespace plvo
