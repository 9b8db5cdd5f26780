// SPDX-License-Identifier: Apache-2.0
// Tests motions chained over a second: their NEES is 6 if the covariances are correct and independent; it
// reveals both overconfidence and correlated errors.
#include "plvo/eval/motion_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dense.hpp"
#include "normal.hpp"
#include "plvo/base/random.hpp"
#include "plvo/eval/consistency.hpp"

namespace plvo::eval {
namespace {

using test::normal;

constexpr std::int64_t kFrame_ns = 33'333'333;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr int kFrames = 6000;  // 200 s
// One sample from each frame except the last ones; a motion one frame short of a second is accepted.
constexpr std::size_t kSeconds = kFrames - 28;

// A constant twist; linear and spherical interpolation reproduce it exactly.
Se3 truth_at(std::int64_t stamp_ns) {
  const double t = static_cast<double>(stamp_ns) * 1e-9;
  return {rotation_exp(t * Vector3(0.1, 0.5, -0.2)), t * Vector3(0.3, -0.1, 0.2)};
}

// Motion capture at 100 Hz, at stamps different from those of the frames.
const Trajectory& ground_truth() {
  static const Trajectory truth = [] {
    Trajectory poses;
    for (std::int64_t t = -3'000'000; t < (kFrames + 2) * kFrame_ns; t += 10'000'000)
      poses.poses.push_back({t, truth_at(t)});
    return poses;
  }();
  return truth;
}

// A full covariance that couples translation and rotation; a millimetre and a milliradian in size.
Matrix6 covariance() {
  Random random(5);
  Matrix6 A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = 1e-3 * normal(random);
  const Eigen::Matrix<double, 6, 6> B = A;
  return B * B.transpose() + 1e-7 * Eigen::Matrix<double, 6, 6>::Identity();
}

struct Drawing {
  int keyframe_every = 1;      // references: the last frame, or the last keyframe
  double claimed_sigma = 1;    // ratio of the reported to the true standard deviation
  double shared_variance = 0;  // fraction of the variance that the motions of one second have in common
};

std::vector<UncertainMotion> draw(const Drawing& how) {
  const Matrix6 C = covariance();
  const Matrix6 L = test::cholesky(C);
  Random random(17);
  const auto noise = [&] {
    Eigen::Matrix<double, 6, 1> n;
    for (int i = 0; i < 6; ++i) n[i] = normal(random);
    return n;
  };
  std::vector<UncertainMotion> motions;
  Eigen::Matrix<double, 6, 1> shared = noise();
  for (int k = 1; k <= kFrames; ++k) {
    if (k % 60 == 0) shared = noise();
    const std::int64_t now = k * kFrame_ns;
    const std::int64_t reference = (k - 1) / how.keyframe_every * how.keyframe_every * kFrame_ns;
    const Eigen::Matrix<double, 6, 1> unit =
        std::sqrt(1 - how.shared_variance) * noise() + std::sqrt(how.shared_variance) * shared;
    const Vector6 error = L * unit;
    motions.push_back({now, reference, boxplus(truth_at(now).inverse() * truth_at(reference), error),
                       C * (how.claimed_sigma * how.claimed_sigma)});
  }
  return motions;
}

Consistency per_motion(const std::vector<UncertainMotion>& motions) {
  return motion_consistency(motions, ground_truth(), {.max_difference_ns = 1}, {});
}
Consistency per_second(const std::vector<UncertainMotion>& motions) {
  return span_consistency(motions, kSecond_ns, ground_truth(), {.max_difference_ns = 1}, {});
}

bool in_its_band(const Nees& nees) {
  return nees.mean > nees.mean_band.low && nees.mean < nees.mean_band.high &&
         nees.median > nees.median_band.low && nees.median < nees.median_band.high;
}

TEST(MotionChain, CorrectCovariancesGiveANeesOfSixOverASecond) {
  const Consistency c = per_second(draw({}));
  EXPECT_EQ(c.count, kSeconds);
  EXPECT_EQ(c.independent, 200u);
  EXPECT_EQ(c.broken, 0u);
  EXPECT_NEAR(c.all.mean, 6, 0.5);
  EXPECT_NEAR(c.translation.mean, 3, 0.35);
  EXPECT_NEAR(c.rotation.mean, 3, 0.35);
  EXPECT_TRUE(in_its_band(c.all));
  EXPECT_TRUE(in_its_band(c.translation));
  EXPECT_TRUE(in_its_band(c.rotation));
}

TEST(MotionChain, FramesAreConnectedThroughTheirKeyframes) {
  // The chain leads from a frame to its keyframe, to the keyframe a second before, and on to that frame.
  const Consistency c = per_second(draw({.keyframe_every = 7}));
  EXPECT_EQ(c.count, kSeconds);
  EXPECT_NEAR(c.all.mean, 6, 0.5);
  EXPECT_TRUE(in_its_band(c.all));
}

TEST(MotionChain, OverconfidenceShowsInBothTests) {
  const std::vector<UncertainMotion> motions = draw({.claimed_sigma = 0.5});
  EXPECT_NEAR(per_motion(motions).all.mean, 24, 1);
  const Consistency c = per_second(motions);
  EXPECT_NEAR(c.all.mean, 24, 2);
  EXPECT_GT(c.translation.mean, c.translation.mean_band.high);
  EXPECT_GT(c.rotation.median, c.rotation.median_band.high);
}

TEST(MotionChain, CorrelationShowsOnlyOverASecond) {
  const std::vector<UncertainMotion> motions = draw({.shared_variance = 0.1});
  EXPECT_NEAR(per_motion(motions).all.mean, 6, 0.6);
  // The sum of 30 motions with variance 1 has the variance 30·0.9 + 30²·0.1, where 30 is reported: 3.9 times
  // as much if all share one error. It is less for a span that contains two such errors.
  const Consistency c = per_second(motions);
  EXPECT_GT(c.all.mean, 2.5 * 6);
  EXPECT_LT(c.all.mean, 3.9 * 6 * 1.2);
  EXPECT_GT(c.all.mean, c.all.mean_band.high);
}

TEST(MotionChain, ComposesAsTheCoreDoes) {
  const Matrix6 C = covariance();
  const std::vector<UncertainMotion> motions = {{1, 0, truth_at(kSecond_ns), C},
                                                {2, 1, truth_at(2 * kSecond_ns), 2 * C},
                                                {3, 1, truth_at(kSecond_ns / 2), C}};
  const MotionChain chain(motions);
  ASSERT_EQ(chain.stamps_ns().size(), 4u);
  Se3 T;
  Matrix6 sum;
  ASSERT_TRUE(chain.between(0, 2, T, sum));
  const Se3 T_2_0 = motions[1].T_camera_reference * motions[0].T_camera_reference;
  EXPECT_LT(boxminus(T, T_2_0).norm(), 1e-12);
  const Matrix6 expected =
      compose_covariance(motions[1].T_camera_reference, 2 * C, motions[0].T_camera_reference, C);
  EXPECT_LT((sum - expected).norm(), 1e-12 * expected.norm());
  // A motion between two branches, and its inverse.
  ASSERT_TRUE(chain.between(2, 3, T, sum));
  EXPECT_LT(boxminus(T, motions[2].T_camera_reference * motions[1].T_camera_reference.inverse()).norm(),
            1e-12);
  Se3 T_back;
  Matrix6 back;
  ASSERT_TRUE(chain.between(3, 2, T_back, back));
  EXPECT_LT(boxminus(T_back, T.inverse()).norm(), 1e-12);
  EXPECT_LT((back - inverse_covariance(T, sum)).norm(), 1e-9 * back.norm());
}

TEST(MotionChain, LostFrameBreaksTheChain) {
  std::vector<UncertainMotion> motions = draw({});
  motions.erase(motions.begin() + 3000);
  const Consistency c = per_second(motions);
  EXPECT_EQ(c.broken, 30u);
  EXPECT_EQ(c.count, kSeconds - 30u);
  EXPECT_NEAR(c.all.mean, 6, 0.5);
  // A motion whose reference is newer than itself is ignored.
  motions = {{1, 2, {}, covariance()}, {2, 1, {}, covariance()}};
  Se3 T;
  Matrix6 C;
  const MotionChain chain(motions);
  EXPECT_TRUE(chain.between(0, 1, T, C));
  motions.pop_back();
  EXPECT_FALSE(MotionChain(motions).between(0, 1, T, C));
}

}  // namespace
}  // namespace plvo::eval
