// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line3d.hpp"

#include <gtest/gtest.h>

#include "line3d_reference.hpp"
#include "line_scene.hpp"
#include "plvo/lines/plane_line.hpp"

namespace plvo {
namespace {

using test::kSeed;
using test::LineScene;

double signed_distance(const Whitened& s, const PlaneLine& line) {
  const Distance d = distance(s, Chord(line));
  return d.cross * std::sqrt(d.inverse_norm2);
}

TEST(PlaneLine, DistanceEqualsThatInThreeDimensions) {
  Random random(7);
  const Pinhole pinhole{520, 540, 320, 240};
  for (int trial = 0; trial < 50; ++trial) {
    const Segment s = test::random_segment(random, 60, 400);
    const double sigma_p = 0.5 + random.uniform();
    const double half = 0.5 * s.length_px();
    const PlaneLine line{-half, 1 + 3 * random.uniform(), half, 1 + 3 * random.uniform()};
    const double t = (2 * random.uniform() - 1) * half, d = 1 + 3 * random.uniform();
    const double sigma_d = 0.01 + 0.05 * random.uniform();
    const Vector2 px = s.middle() + t * s.direction();
    const Point3d point = observe_point(pinhole, px.x(), px.y(), d, sigma_p, sigma_d);
    const Vector3 a = back_project(pinhole, s.a.x(), s.a.y(), line.z_a);
    const Vector3 b = back_project(pinhole, s.b.x(), s.b.y(), line.z_b);
    const Whitened w = whiten(t, d, sigma_p, sigma_d);
    const double expected = reference::mahalanobis_by_search(point, a, b);
    EXPECT_NEAR(std::abs(signed_distance(w, line)), expected, 1e-6 * (1 + expected));
    EXPECT_NEAR(squared_distance(w, Chord(line)), expected * expected, 1e-6 * (1 + expected * expected));
    const Vector3 foot = point.p - reference::delta(point, a, b);
    const Vector2 foot_px = project(pinhole, foot);
    EXPECT_NEAR((foot_px - s.middle()).dot(s.direction()), foot_pixel(w, Chord(line)), 1e-6);
  }
}

TEST(PlaneLine, DerivativesMatchDifferences) {
  Random random(8);
  for (int trial = 0; trial < 100; ++trial) {
    const PlaneLine line{-80, 1 + 2 * random.uniform(), 90, 1 + 2 * random.uniform()};
    const Whitened w = whiten(160 * random.uniform() - 80, 1 + 2 * random.uniform(), 0.7, 0.02);
    const Distance d = distance(w, Chord(line));
    const double root = std::sqrt(d.inverse_norm2);
    const double h = 1e-6;
    PlaneLine plus = line, minus = line;
    plus.z_a += h, minus.z_a -= h;
    const double by_a = (signed_distance(w, plus) - signed_distance(w, minus)) / (2 * h);
    plus = minus = line;
    plus.z_b += h, minus.z_b -= h;
    const double by_b = (signed_distance(w, plus) - signed_distance(w, minus)) / (2 * h);
    EXPECT_NEAR((1 - d.lambda) * (d.normal_x * line.t_a + d.normal_z) * root, by_a,
                1e-4 * (1 + std::abs(by_a)));
    EXPECT_NEAR(d.lambda * (d.normal_x * line.t_b + d.normal_z) * root, by_b, 1e-4 * (1 + std::abs(by_b)));
  }
}

TEST(PlaneLine, ReAnchoringKeepsTheLine) {
  const PlaneLine line{-50, 1.5, 40, 2.5};
  PlaneLine moved = line;
  ASSERT_TRUE(re_anchor(moved, -10, 12));
  const Whitened w = whiten(5, 2.2, 0.5, 0.02);
  EXPECT_NEAR(signed_distance(w, line), signed_distance(w, moved), 1e-9);
  EXPECT_FALSE(re_anchor(moved, -50, 5000));  // beyond the line's vanishing point
}

// Without outliers the fast solution in the plane must equal the dense solution over [A, B].
TEST(Line3d, AgreesWithTheDenseSolution) {
  Random random(9);
  const Pinhole pinhole{520, 540, 320, 240};
  for (int trial = 0; trial < 20; ++trial) {
    LineScene scene = LineScene::random(random, pinhole);
    const Line3dConfig config = Line3dConfig::paper();
    const double any = 1e9;  // both solutions use every sample
    const LineSamples samples = scene.noisy_samples(random, config.sigma_p_px, DepthNoise{});
    Line3d line;
    const Line3dReport report = fit_line3d(scene.segment, samples, pinhole, config, kSeed, line, any);
    ASSERT_EQ(report.outcome, Line3dOutcome::kOk);
    std::vector<Point3d> points;
    for (const LineSample& s : samples.with_depth()) {
      const Vector2 px = scene.segment.middle() + s.t_px * scene.segment.direction();
      points.push_back(observe_point(pinhole, px.x(), px.y(), s.depth_m, config.sigma_p_px, s.sigma_d_m));
    }
    const reference::Mle mle = reference::maximum_likelihood(points);
    EXPECT_NEAR(report.cost, mle.cost, 1e-5 * mle.cost);
    // The fast solution stops at a thousandth of a standard deviation.
    const Vector6 sd = mle.covariance.diagonal().cwiseSqrt();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(line.a(k), mle.L(k), 5e-3 * sd(k));
      EXPECT_NEAR(line.b(k), mle.L(3 + k), 5e-3 * sd(3 + k));
    }
    const Matrix6 scale = sd.cwiseInverse().asDiagonal();
    EXPECT_LT((scale * (line.Sigma - mle.covariance) * scale).norm(), 0.02);
  }
}

TEST(Line3d, EndsHaveTheOrderOfTheSegment) {
  Random random(10);
  const Pinhole pinhole;
  const LineScene scene = LineScene::random(random, pinhole);
  Line3d line;
  ASSERT_EQ(fit_line3d(scene.segment, scene.exact_samples(), pinhole, {}, kSeed, line).outcome,
            Line3dOutcome::kOk);
  EXPECT_LT((project(pinhole, line.a) - scene.segment.a).norm(), 1e-6);
  EXPECT_LT((project(pinhole, line.b) - scene.segment.b).norm(), 1e-6);
  EXPECT_LT((line.a - scene.a).norm() + (line.b - scene.b).norm(), 1e-8);
}

TEST(Line3d, ExcludesWrongDepths) {
  Random random(11);
  const Pinhole pinhole;
  int found = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const LineScene scene = LineScene::random(random, pinhole);
    LineSamples samples = scene.noisy_samples(random, 0.5, DepthNoise{});
    for (int i = 0; i < samples.count; ++i)  // a third of them far behind
      if (i % 3 == 1) samples.sample[static_cast<std::size_t>(i)].depth_m *= 1.3 + random.uniform();
    Line3d line;
    if (fit_line3d(scene.segment, samples, pinhole, Line3dConfig::paper(), kSeed, line).outcome !=
        Line3dOutcome::kOk)
      continue;
    ++found;
    EXPECT_LT(test::offset_from_line(line.a, scene.a, scene.b), 0.08);
    EXPECT_LT(test::offset_from_line(line.b, scene.a, scene.b), 0.08);
  }
  EXPECT_GE(found, 47);
}

// Two walls cover 70 % and 30 % of one segment. This is not a line, though the larger part alone would pass
// τ.
TEST(Line3d, RejectsASegmentOverTwoSurfaces) {
  Random random(15);
  const Pinhole pinhole;
  int with_paper = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const LineScene scene = LineScene::random(random, pinhole);
    LineSamples samples = scene.noisy_samples(random, 0.5, DepthNoise{});
    for (int i = samples.count * 7 / 10; i < samples.count; ++i)
      samples.sample[static_cast<std::size_t>(i)].depth_m += 0.4;
    Line3d line;
    EXPECT_NE(fit_line3d(scene.segment, samples, pinhole, {}, kSeed, line).outcome, Line3dOutcome::kOk);
    with_paper += fit_line3d(scene.segment, samples, pinhole, Line3dConfig::paper(), kSeed, line).outcome ==
                  Line3dOutcome::kOk;
  }
  EXPECT_GT(with_paper, 30);
}

TEST(Line3d, ToleratesMissingDepthDownToTheThreshold) {
  Random random(12);
  const Pinhole pinhole;
  for (const int percent : {0, 30, 60}) {
    int found = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const LineScene scene = LineScene::random(random, pinhole);
      LineSamples samples = scene.noisy_samples(random, 0.5, DepthNoise{});
      int kept = 0;
      for (int i = 0; i < samples.count; ++i)
        if ((i * 7) % 10 >= percent / 10)
          samples.sample[static_cast<std::size_t>(kept++)] = samples.sample[static_cast<std::size_t>(i)];
      samples.count = kept;
      Line3d line;
      found +=
          fit_line3d(scene.segment, samples, pinhole, {}, kSeed, line).outcome == Line3dOutcome::kOk ? 1 : 0;
    }
    if (percent < 60)
      EXPECT_GE(found, 38) << percent;
    else
      EXPECT_EQ(found, 0);  // below τ
  }
}

// An arc seen edge-on projects to a straight segment.
TEST(Line3d, RejectsAnArcSeenEdgeOn) {
  Random random(13);
  const Pinhole pinhole;
  for (const double sagitta_m : {0.4, 0.7, -0.4}) {
    int accepted = 0;
    for (int trial = 0; trial < 40; ++trial) {
      LineScene scene = LineScene::random(random, pinhole);
      LineSamples samples = scene.exact_samples();
      for (int i = 0; i < samples.count; ++i) {
        LineSample& s = samples.sample[static_cast<std::size_t>(i)];
        const double u = 2 * s.t_px / scene.segment.length_px();
        s.depth_m += sagitta_m * (1 - u * u);
        s.sigma_d_m = DepthNoise{}.sigma(s.depth_m);
        s.depth_m += s.sigma_d_m * test::gaussian(random);
      }
      Line3d line;
      accepted +=
          fit_line3d(scene.segment, samples, pinhole, {}, kSeed, line).outcome == Line3dOutcome::kOk ? 1 : 0;
    }
    EXPECT_LE(accepted, 4) << sagitta_m;
  }
}

TEST(Line3d, ResultDoesNotDependOnTheOrderOfCalls) {
  Random random(14);
  const Pinhole pinhole;
  const LineScene one = LineScene::random(random, pinhole), two = LineScene::random(random, pinhole);
  LineSamples samples = one.noisy_samples(random, 0.5, DepthNoise{});
  for (int i = 0; i < samples.count; i += 4) samples.sample[static_cast<std::size_t>(i)].depth_m += 1;
  Line3d first, other, again;
  (void)fit_line3d(one.segment, samples, pinhole, {}, kSeed, first);
  (void)fit_line3d(two.segment, two.exact_samples(), pinhole, {}, kSeed, other);
  (void)fit_line3d(one.segment, samples, pinhole, {}, kSeed, again);
  EXPECT_EQ(first.a, again.a);
  EXPECT_EQ(first.Sigma, again.Sigma);
}

TEST(Line3d, ReturnsTooFewDepthsWithoutLengthOrDepth) {
  Line3d line;
  Segment s;
  EXPECT_EQ(observe_line(s, test::DepthFunction{[](int, int) { return 1.0; }}, Pinhole{}, DepthNoise{}, {},
                         kSeed, line)
                .outcome,
            Line3dOutcome::kTooFewDepths);
  s.b = {30, 0};
  EXPECT_EQ(observe_line(s, test::DepthFunction{[](int, int) { return 0.0; }}, Pinhole{}, DepthNoise{}, {},
                         kSeed, line)
                .outcome,
            Line3dOutcome::kTooFewDepths);
}

}  // namespace
}  // namespace plvo
