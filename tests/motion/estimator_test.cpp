// SPDX-License-Identifier: Apache-2.0
// The estimator as the odometry uses it: outliers, little evidence, bad input, determinism.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void expect_finite(const MotionEstimate& estimate) {
  EXPECT_TRUE(estimate.T_current_reference.is_finite());
  EXPECT_TRUE(estimate.C_H.allFinite());
  EXPECT_TRUE(std::isfinite(estimate.lm.initial_cost) && std::isfinite(estimate.lm.final_cost));
  EXPECT_TRUE(std::isfinite(estimate.ransac.score));
}

struct Share {
  int points, lines;
  double outliers;
};
class Outliers : public ::testing::TestWithParam<Share> {};

TEST_P(Outliers, AreFound) {
  const Share& c = GetParam();
  Gaussian gaussian(7);
  Bench bench;
  MotionConfig config;
  config.max_ransac_iterations = 500;
  for (int trial = 0; trial < 20; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, c.points, c.lines, c.outliers);
    const MotionEstimate estimate = bench.estimate(pair, config, static_cast<std::uint64_t>(trial));
    ASSERT_EQ(estimate.status, StatusCode::kOk) << "trial " << trial;
    expect_finite(estimate);
    // χ²(6) exceeds 30 once in 25 000.
    EXPECT_LT(test::nees(estimate.T_current_reference, pair.truth, test::inverse(estimate.C_H)), 30)
        << "trial " << trial;
    const double good = (1 - c.outliers) * (c.points + c.lines);
    const int inliers = estimate.inliers[0] + estimate.inliers[1];
    EXPECT_GT(inliers, 0.85 * good);
    EXPECT_LT(inliers, good + 0.05 * (c.points + c.lines) + 2);
  }
}
INSTANTIATE_TEST_SUITE_P(Shares, Outliers,
                         ::testing::Values(Share{100, 0, 0.3}, Share{100, 0, 0.5}, Share{100, 0, 0.7},
                                           Share{0, 40, 0.3}, Share{0, 40, 0.5}, Share{0, 40, 0.7},
                                           Share{60, 20, 0.3}, Share{60, 20, 0.5}, Share{60, 20, 0.7}));

// A room of 24 points, and a near object with `crowd` points in the middle of the image that moves otherwise.
struct TwoMotions {
  TwoMotions(Gaussian& gaussian, int crowd) {
    room.truth = boxplus(Se3(), 0.02 * gaussian.vector<6>());
    object = boxplus(room.truth, Vector6(0.12, -0.08, 0.05, 0.05, 0.06, -0.05));
    for (int i = 0; i < 24; ++i) {
      const double z = gaussian.uniform(2, 4);
      room.add_point(gaussian, {z * gaussian.uniform(-0.5, 0.5), z * gaussian.uniform(-0.4, 0.4), z});
    }
    const Se3 T_room = room.truth;
    room.truth = object;
    for (int i = 0; i < crowd; ++i)
      room.add_point(gaussian, {gaussian.uniform(-0.08, 0.08), gaussian.uniform(-0.08, 0.08),
                                gaussian.uniform(0.55, 0.65)});
    room.truth = T_room;
  }
  SimulatedPair room;
  Se3 object;
};

TEST(Estimator, TheMotionOfTheLargerPartOfTheSceneWins) {
  Gaussian gaussian(23);
  Bench bench;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    const TwoMotions scene(gaussian, 60);
    // Found with the object's motion as the start, and found without any.
    for (const MotionStart& start : {MotionStart(&scene.object, {}, true), MotionStart(nullptr)}) {
      const MotionEstimate estimate = bench.estimate(scene.room, {}, trial, start);
      ASSERT_EQ(estimate.status, StatusCode::kOk) << "trial " << trial;
      EXPECT_LT(test::nees(estimate.T_current_reference, scene.room.truth, test::inverse(estimate.C_H)), 30)
          << "trial " << trial;
    }
  }
}

// Without the room the object is all there is.
TEST(Estimator, KeepsAMotionWithoutARivalInTheScene) {
  Gaussian gaussian(24);
  Bench bench;
  TwoMotions scene(gaussian, 60);
  SimulatedPair& pair = scene.room;
  pair.point_matches.erase(pair.point_matches.begin(), pair.point_matches.begin() + 24);
  const MotionEstimate estimate = bench.estimate(pair, {}, 1, {&scene.object, {}, true});
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  EXPECT_EQ(estimate.ransac.draws, 0);
  EXPECT_LT(test::nees(estimate.T_current_reference, scene.object, test::inverse(estimate.C_H)), 30);
}

// A room whose landmarks have agreed before, or not yet, and new landmarks in front of it, three times as
// many and over the whole image. `apart`: how far they have moved by themselves.
struct Newcomers {
  Newcomers(Gaussian& gaussian, bool proven, double apart) {
    room.truth = boxplus(Se3(), 0.02 * gaussian.vector<6>());
    const auto add = [&](int n, double z) {
      for (int i = 0; i < n; ++i)
        room.add_point(gaussian, {z * gaussian.uniform(-0.5, 0.5), z * gaussian.uniform(-0.4, 0.4),
                                  z + gaussian.uniform(-0.2, 0.2)});
    };
    add(kRoom, 3);
    if (proven)
      for (Point3d& point : room.points_reference) point.record = LandmarkRecord(LandmarkRecord::kProven);
    const Se3 T_room = room.truth;
    room.truth = object = boxplus(T_room, Vector6(apart, 0, 0, 0, 0, 0));
    add(3 * kRoom, 2);
    room.truth = T_room;
  }
  static constexpr int kRoom = 24;
  SimulatedPair room;
  Se3 object;
};

TEST(Estimator, NewLandmarksDoNotOutvoteProvenOnes) {
  Gaussian gaussian(31);
  Bench bench;
  int followed = 0;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    for (const bool proven : {true, false}) {
      const Newcomers scene(gaussian, proven, 0.1);
      for (const MotionStart& start : {MotionStart(&scene.object, {}, true), MotionStart(nullptr)}) {
        const MotionEstimate estimate = bench.estimate(scene.room, {}, trial, start);
        ASSERT_EQ(estimate.status, StatusCode::kOk) << "trial " << trial;
        const double nees =
            test::nees(estimate.T_current_reference, scene.room.truth, test::inverse(estimate.C_H));
        if (proven)
          EXPECT_LT(nees, 30) << "trial " << trial;
        else
          followed += nees > 30 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(followed, 30);  // of 40: without records nothing tells the two apart
}

TEST(Estimator, NewLandmarksThatAgreeCountAsMuchAsProvenOnes) {
  Gaussian gaussian(32);
  Bench bench;
  const Newcomers scene(gaussian, true, 0);
  const MotionEstimate estimate = bench.estimate(scene.room, {}, 1, MotionStart(nullptr));
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  EXPECT_GT(estimate.inliers[0], 3 * Newcomers::kRoom);
}

// After a fast rotation a few proven landmarks are left at the border, many of them matched wrongly. Those of
// them that agree with each other by chance do not decide.
TEST(Estimator, ProvenLandmarksOfWhichMostDisagreeDoNotLead) {
  Gaussian gaussian(33);
  Bench bench;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Newcomers scene(gaussian, false, 0);
    SimulatedPair& room = scene.room;
    const Se3 T_room = room.truth;
    const Se3 by_chance = boxplus(T_room, Vector6(0.1, 0, 0, 0, 0, 0));
    constexpr int kProven = 24, kAgree = 11;
    for (int i = 0; i < kProven; ++i) {
      room.truth = i < kAgree ? by_chance : boxplus(T_room, 0.2 * gaussian.vector<6>());
      room.add_point(gaussian, {gaussian.uniform(-1.5, 1.5), gaussian.uniform(-1.2, 1.2), 3});
      room.points_reference.back().record = LandmarkRecord(LandmarkRecord::kProven);
    }
    room.truth = T_room;
    const MotionEstimate estimate = bench.estimate(room, {}, trial, {&by_chance, {}, true});
    ASSERT_EQ(estimate.status, StatusCode::kOk) << "trial " << trial;
    EXPECT_FALSE(estimate.is_other) << "trial " << trial;
    EXPECT_LT(test::nees(estimate.T_current_reference, T_room, test::inverse(estimate.C_H)), 30)
        << "trial " << trial;
  }
}

TEST(Estimator, NoMatchesGiveTooFewFeatures) {
  Bench bench;
  const SimulatedPair pair;
  const MotionEstimate estimate = bench.estimate(pair);
  EXPECT_EQ(estimate.status, StatusCode::kTooFewFeatures);
  expect_finite(estimate);
}

TEST(Estimator, SameSeedSameBits) {
  Gaussian gaussian(11);
  const SimulatedPair pair = test::simulate(gaussian, 200, 40, 0.4);
  Bench first, second(2 << 20);
  const MotionEstimate a = first.estimate(pair, {}, 42);
  const MotionEstimate b = second.estimate(pair, {}, 42);
  EXPECT_EQ(0, std::memcmp(&a.T_current_reference, &b.T_current_reference, sizeof(Se3)));
  EXPECT_EQ(0, std::memcmp(&a.C_H, &b.C_H, sizeof(Matrix6)));
  EXPECT_EQ(a.ransac.draws, b.ransac.draws);
}

// A pair whose motion RANSAC has drawn, and what other starts lead to.
struct DrawnPair {
  DrawnPair(std::uint64_t seed, int points, int lines, double outliers) {
    Gaussian gaussian(seed);
    pair = test::simulate(gaussian, points, lines, outliers);
    drawn = bench.estimate(pair, {}, 42);
  }
  MotionEstimate estimate_from(const Vector6& off) {
    const Se3 start = boxplus(pair.truth, off);
    return bench.estimate(pair, {}, 42, {&start, {}, true});
  }
  double nees(const MotionEstimate& found) const {
    return test::nees(found.T_current_reference, drawn.T_current_reference, test::inverse(drawn.C_H));
  }

  SimulatedPair pair;
  Bench bench;
  MotionEstimate drawn;
};

TEST(Estimator, RefinesAnAgreeingPredictionWithoutHypotheses) {
  DrawnPair pair(17, 200, 40, 0.2);
  ASSERT_EQ(pair.drawn.status, StatusCode::kOk);
  Vector6 off;
  off << 3e-3, -2e-3, 2e-3, 2e-3, -1e-3, 1e-3;
  const MotionEstimate refined = pair.estimate_from(off);
  ASSERT_EQ(refined.status, StatusCode::kOk);
  EXPECT_EQ(refined.ransac.draws, 0);
  EXPECT_LT(pair.nees(refined), 0.1);

  // Nothing agrees with it: it is a prediction like any other.
  const MotionEstimate found = pair.estimate_from(200 * off);
  ASSERT_EQ(found.status, StatusCode::kOk);
  EXPECT_GT(found.ransac.draws, 0);
  EXPECT_LT(pair.nees(found), 0.1);
}

// Nothing, little or much of the matches may agree with an estimate, at first or when it is refined.
TEST(Estimator, FindsTheMotionFromAnyInitialEstimate) {
  DrawnPair pair(23, 100, 30, 0.3);
  ASSERT_EQ(pair.drawn.status, StatusCode::kOk);
  Vector6 off;
  off << 2e-3, -1e-3, 1e-3, 1e-3, -1e-3, 1e-3;
  for (double far = 1; far < 300; far *= 1.1) {
    const MotionEstimate found = pair.estimate_from(far * off);
    ASSERT_EQ(found.status, StatusCode::kOk) << far;
    // The same matches, and so the same motion but for where the solver stops.
    EXPECT_LT(pair.nees(found), 1e-6) << far;
  }
}

// As the odometry stops: what is left is small beside what the matches can tell.
TEST(Estimator, ALastStepWithoutEvaluationIsAsAccurate) {
  Gaussian gaussian(19);
  Bench bench;
  for (int trial = 0; trial < 30; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 60, 20, 0.2);
    const Se3 near = boxplus(pair.truth, 3e-3 * gaussian.vector<6>());
    const MotionStart start(&near, {}, true);
    const MotionEstimate exact = bench.estimate(pair, {}, 42, start, {.step_tolerance = 1e-12});
    const MotionEstimate unchecked = bench.estimate(pair, {}, 42, start, {.decrease_tolerance = 2e-2});
    ASSERT_EQ(exact.status, StatusCode::kOk);
    ASSERT_EQ(unchecked.status, StatusCode::kOk);
    EXPECT_LE(unchecked.lm.iterations, exact.lm.iterations);
    const double left =
        test::nees(unchecked.T_current_reference, exact.T_current_reference, test::inverse(exact.C_H));
    EXPECT_LT(left, 0.05 * 0.05) << trial;
  }
}

int usable_matches(const ConstraintSet& set) {
  int count = 0;
  for (std::size_t i = 0; i < set.size(); ++i) count += set.usable(i) ? 1 : 0;
  return count;
}

TEST(Estimator, LeavesOutMatchesWithNaN) {
  Gaussian gaussian(12);
  SimulatedPair pair = test::simulate(gaussian, 60, 20);
  pair.points_reference[3].p.x() = kNaN;
  pair.points_current[4].Sigma(1, 1) = kNaN;
  pair.points_current[5].Sigma *= -1;
  pair.lines_reference[2].a.y() = kNaN;
  pair.lines_current[3].Sigma(5, 5) = std::numeric_limits<double>::infinity();
  pair.lines_current[4].b = pair.lines_current[4].a;
  Bench bench;
  const MotionEstimate estimate = bench.estimate(pair);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  expect_finite(estimate);
  EXPECT_EQ(usable_matches(*bench.sets[0]), 57);
  EXPECT_EQ(usable_matches(*bench.sets[1]), 17);
  for (int i : {3, 4, 5}) EXPECT_EQ(bench.points[0].inliers()[static_cast<std::size_t>(i)], 0);
}

TEST(Estimator, MatchesWithAHugeCovarianceDoNotChangeTheEstimate) {
  Gaussian gaussian(13);
  SimulatedPair pair = test::simulate(gaussian, 60, 20);
  Bench bench;
  const MotionEstimate before = bench.estimate(pair);
  pair.points_reference[0].Sigma *= 1e12;  // refused: more than a metre
  pair.lines_reference[0].Sigma *= 1e12;
  pair.points_reference[1].Sigma = 0.3 * Matrix3::Identity();  // taken, and worth nothing
  const MotionEstimate after = bench.estimate(pair);
  ASSERT_EQ(before.status, StatusCode::kOk);
  ASSERT_EQ(after.status, StatusCode::kOk);
  expect_finite(after);
  EXPECT_EQ(usable_matches(*bench.sets[0]), 59);
  EXPECT_EQ(usable_matches(*bench.sets[1]), 19);
  EXPECT_LT(test::nees(after.T_current_reference, pair.truth, test::inverse(after.C_H)), 30);
}

// Everything that cannot fix six degrees of freedom is refused, never answered with nonsense.
void expect_refused(const SimulatedPair& pair) {
  Bench bench;
  for (const Se3* prediction : {static_cast<const Se3*>(nullptr), &pair.truth}) {
    const MotionEstimate estimate = bench.estimate(pair, {}, 3, prediction);
    EXPECT_TRUE(estimate.status == StatusCode::kDegenerate || estimate.status == StatusCode::kNoConsensus)
        << static_cast<int>(estimate.status);
    expect_finite(estimate);
    EXPECT_TRUE(estimate.T_current_reference.R.isIdentity());
    EXPECT_EQ(estimate.inliers[0] + estimate.inliers[1], 0);
  }
}

TEST(Estimator, CollinearPointsAreDegenerate) {
  Gaussian gaussian(14);
  SimulatedPair pair;
  pair.truth = test::random_motion(gaussian);
  for (int i = 0; i < 40; ++i)
    pair.add_point(gaussian, Vector3(-0.8, 0.1, 2) + 0.04 * i * Vector3(1, 0.1, 0.2));
  expect_refused(pair);
}

TEST(Estimator, ParallelLinesAreDegenerate) {
  Gaussian gaussian(15);
  SimulatedPair pair;
  pair.truth = test::random_motion(gaussian);
  for (int i = 0; i < 30; ++i) {
    const Vector3 a = test::random_point(gaussian);
    pair.add_line(gaussian, a, a + Vector3(0, 0.6, 0));
  }
  expect_refused(pair);
}

TEST(Estimator, CoplanarFeaturesDetermineTheMotion) {
  Gaussian gaussian(16);
  SimulatedPair pair;
  pair.truth = test::random_motion(gaussian);
  const auto on_wall = [&] { return Vector3(gaussian.uniform(-1, 1), gaussian.uniform(-0.8, 0.8), 2); };
  for (int i = 0; i < 40; ++i) pair.add_point(gaussian, on_wall());
  Bench bench;
  EXPECT_EQ(bench.estimate(pair).status, StatusCode::kOk);
  for (int i = 0; i < 20; ++i) pair.add_line(gaussian, on_wall(), on_wall());
  EXPECT_EQ(bench.estimate(pair).status, StatusCode::kOk);
  pair.point_matches.clear();
  EXPECT_EQ(bench.estimate(pair).status, StatusCode::kOk) << "lines alone";
}

TEST(Estimator, RandomMatchesGiveNoConsensus) {
  Gaussian gaussian(17);
  const SimulatedPair pair = test::simulate(gaussian, 60, 20, 1.0);
  Bench bench;
  const MotionEstimate estimate = bench.estimate(pair);
  EXPECT_EQ(estimate.status, StatusCode::kNoConsensus);
  expect_finite(estimate);
}

TEST(Estimator, IterationsStayWithinTheirBounds) {
  Gaussian gaussian(18);
  const SimulatedPair pair = test::simulate(gaussian, 100, 30, 0.9);
  Bench bench;
  MotionConfig config;
  config.max_ransac_iterations = 50;
  const MotionEstimate estimate = bench.estimate(pair, config, 1, nullptr, {.max_iterations = 1});
  EXPECT_LE(estimate.ransac.iterations, 50);
  EXPECT_LE(estimate.ransac.draws, 200);
  EXPECT_LE(estimate.lm.iterations, 1);
  expect_finite(estimate);
}

TEST(Estimator, ThePredictionIsTheFirstHypothesis) {
  Gaussian gaussian(19);
  const SimulatedPair pair = test::simulate(gaussian, 60, 20, 0.5);
  Bench bench;
  MotionConfig config;
  config.max_ransac_iterations = 0;
  EXPECT_EQ(bench.estimate(pair, config).status, StatusCode::kNoConsensus);
  const Se3 rough = boxplus(pair.truth, (Vector6() << 0.01, -0.01, 0.005, 0.005, 0.002, -0.003).finished());
  const MotionEstimate estimate = bench.estimate(pair, config, 1, &rough);
  ASSERT_EQ(estimate.status, StatusCode::kOk);
  EXPECT_EQ(estimate.ransac.draws, 0);
  EXPECT_LT(test::nees(estimate.T_current_reference, pair.truth, test::inverse(estimate.C_H)), 30);
  const Se3 broken = {Matrix3::Constant(kNaN), Vector3::Zero()};
  expect_finite(bench.estimate(pair, {}, 1, &broken));
}

TEST(Estimator, ReportsATooSmallArena) {
  Gaussian gaussian(20);
  const SimulatedPair pair = test::simulate(gaussian, 60, 0);
  Bench bench;
  bench.load(pair);
  std::vector<std::byte> nothing(64);
  Arena full{std::span<std::byte>(nothing)};
  (void)full.take<std::byte>("test", 64);
  EXPECT_EQ(estimate_motion(bench.sets, {}, MotionReferences{}, {}, {}, 1, nullptr, full).status,
            StatusCode::kOutOfMemory);
}

TEST(Estimator, ReleasesItsScratchAndTakesTheStatedSize) {
  Gaussian gaussian(21);
  const SimulatedPair pair = test::simulate(gaussian, 100, 30);
  constexpr std::size_t kNeeded = [] {
    Arena sizer = Arena::counting();
    size_motion(sizer, 1, 100, 30);
    return sizer.peak();
  }();
  Bench bench(kNeeded + kArenaAlignment);
  EXPECT_EQ(bench.estimate(pair).status, StatusCode::kOk);
  EXPECT_FALSE(bench.arena.exhausted());
  EXPECT_LE(bench.arena.peak(), kNeeded);
  EXPECT_LT(bench.arena.used(), bench.arena.peak());
}

// Another term of the cost: points of the current frame on known planes of the reference frame, with one
// degree of freedom each and no landmark.
class PlaneSamples final : public CostTerm {
 public:
  struct Sample {
    Vector3 normal, on_plane, measured;  // reference, reference, current
    double sigma;
  };
  explicit PlaneSamples(std::span<const Sample> samples) : CostTerm({}), samples_(samples) {}
  LandmarkKind kind() const override { return LandmarkKind::kSurfaces; }
  int dof() const override { return 1; }
  void begin(const Se3&, const NuisanceParameters&, const RobustKernel&, std::size_t) override {}
  double linearize(const Se3& T, const NuisanceParameters&, const RobustKernel& kernel,
                   JointInformation& sum) const override {
    double cost = 0;
    for (const Sample& sample : samples_) {
      // r = nᵀ R⁻¹ (x − t) − nᵀ q; with n' = R n: ∂r/∂v = −n', ∂r/∂ω = −(x − t) × n' … of nᵀ Rᵀ Exp(−ω)(x −
      // t).
      const Vector3 n = T.R * sample.normal;
      const Vector3 x = sample.measured - T.t;
      Vector6 J;
      J << -n, Vector3(-x.cross(n));
      const double information = 1 / (sample.sigma * sample.sigma);
      const double r = residual(sample, T);
      double weight = 1;
      cost += 0.5 * kernel(r * r * information, weight);
      sum.H.block<6, 6>(0, 0) += weight * information * J * J.transpose();
      sum.g.head<6>() += weight * information * r * J;
    }
    return cost;
  }

 private:
  static double residual(const Sample& sample, const Se3& T) {
    return sample.normal.dot(T.inverse() * sample.measured - sample.on_plane);
  }
  std::span<const Sample> samples_;
};

TEST(Estimator, AcceptsAnotherTermOfTheCost) {
  Gaussian gaussian(22);
  double error_without = 0, error_with = 0, sum_nees = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const SimulatedPair pair = test::simulate(gaussian, 20, 0);
    std::vector<PlaneSamples::Sample> samples;
    for (int i = 0; i < 300; ++i) {
      const Vector3 normal = Vector3::Unit(i % 3);
      const Vector3 q = test::random_point(gaussian);
      samples.push_back({normal, q, pair.truth * Vector3(q + 0.002 * gaussian() * normal), 0.002});
    }
    Bench bench;
    bench.load(pair);
    PlaneSamples planes(samples);
    CostTerm* const others[] = {&planes};
    const MotionEstimate without =
        estimate_motion(bench.sets, {}, MotionReferences{}, {}, {}, 1, nullptr, bench.arena);
    const MotionEstimate with =
        estimate_motion(bench.sets, others, MotionReferences{}, {}, {}, 1, nullptr, bench.arena);
    ASSERT_EQ(without.status, StatusCode::kOk);
    ASSERT_EQ(with.status, StatusCode::kOk);
    error_without += boxminus(without.T_current_reference, pair.truth).norm();
    error_with += boxminus(with.T_current_reference, pair.truth).norm();
    sum_nees += test::nees(with.T_current_reference, pair.truth, test::inverse(with.C_H));
  }
  EXPECT_LT(error_with, 0.5 * error_without);
  EXPECT_NEAR(sum_nees / 50, 6, 2.5);
}

}  // namespace
}  // namespace plvo
