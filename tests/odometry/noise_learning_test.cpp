// SPDX-License-Identifier: Apache-2.0
// Learns the noise scales from matches whose noise variance is a known multiple of the model's.
#include "plvo/odometry/tracking/noise_learning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Bench;
using test::Gaussian;
using test::SimulatedPair;

constexpr double kSigma_px = 0.7;

// A measurement of p. The noise variances across the image and along the ray are multiples of those in the
// covariance.
Point3d observe(Gaussian& gaussian, const Vector3& p, const NoiseScales& truth) {
  const Pinhole pinhole;
  const Vector2 pixel = project(pinhole, p);
  const double sigma_d = DepthNoise{}.sigma(p.z());
  const double u = pixel.x() + std::sqrt(truth.image) * kSigma_px * gaussian();
  const double v = pixel.y() + std::sqrt(truth.image) * kSigma_px * gaussian();
  const double z = p.z() + std::sqrt(truth.depth) * sigma_d * gaussian();
  return observe_point(pinhole, u, v, z, kSigma_px, sigma_d);
}

void add_point(Gaussian& gaussian, SimulatedPair& pair, const NoiseScales& truth, bool outlier) {
  const Vector3 p = test::random_point(gaussian);
  const Vector3 q = pair.truth * (outlier ? test::random_point(gaussian) : p);
  const auto i = static_cast<std::uint16_t>(pair.points_reference.size());
  pair.points_reference.push_back(observe(gaussian, p, truth));
  pair.points_current.push_back(observe(gaussian, q, truth));
  pair.point_matches.push_back({i, i});
}

void add_line(Gaussian& gaussian, SimulatedPair& pair, const NoiseScales& truth, bool outlier) {
  gaussian.set_silent(true);
  pair.add_random_line(gaussian, outlier);
  gaussian.set_silent(false);
  for (Line3d* line : {&pair.lines_reference.back(), &pair.lines_current.back()}) {
    const Vector6 noise = std::sqrt(truth.lines) * gaussian.draw<6>(line->Sigma);
    line->a += noise.head<3>();
    line->b += noise.tail<3>();
  }
}

// A small motion, as between two frames. The first outlier_share of points and of lines are wrong matches.
SimulatedPair simulate(std::uint64_t seed, int points, int lines, const NoiseScales& truth,
                       double outlier_share = 0) {
  Gaussian gaussian(seed);
  SimulatedPair pair;
  pair.truth = boxplus(Se3{}, (Vector6() << 0.01, -0.005, 0.012, 0.004, 0.01, -0.003).finished());
  for (int i = 0; i < points; ++i) add_point(gaussian, pair, truth, i < outlier_share * points);
  for (int i = 0; i < lines; ++i) add_line(gaussian, pair, truth, i < outlier_share * lines);
  return pair;
}

NoiseScales shown_by(const SimulatedPair& pair) {
  Bench bench(8 << 20);
  bench.load(pair);
  return residual_scales(Pinhole{}, bench.points.back(), bench.lines.back(), pair.truth, bench.arena);
}

constexpr int kMany = 4000;
// Relative SD of the median of n squared numbers: 1 / (2 f(m) m √n), where f is the density of χ² with 1, 2
// and 4 degrees of freedom at its median m.
double sampling_sd(int dof, double n) { return (dof == 1 ? 2.33 : dof == 2 ? 1.44 : 0.95) / std::sqrt(n); }

// Tolerance: four SDs of the sampling, plus an allowance. The gate cuts the tail of noise that is larger than
// modelled, and depth noise also appears across the image.
void expect_about(const NoiseScales& shown, const NoiseScales& truth, double n, double allowance) {
  EXPECT_NEAR(shown.image / truth.image, 1, 4 * sampling_sd(2, n) + allowance);
  EXPECT_NEAR(shown.depth / truth.depth, 1, 4 * sampling_sd(1, n) + allowance);
  EXPECT_NEAR(shown.lines / truth.lines, 1, 4 * sampling_sd(4, n) + allowance);
}

TEST(ResidualScales, EstimateTheRatioOfNoiseToItsModel) {
  for (const NoiseScales& truth :
       {NoiseScales{1, 1, 1}, NoiseScales{0.25, 0.25, 0.25}, NoiseScales{2, 2, 2}, NoiseScales{1, 0.25, 1},
        NoiseScales{3, 1, 0.5}, NoiseScales{0.5, 2, 3}, NoiseScales{1, 1, 0.1}}) {
    const NoiseScales shown = shown_by(simulate(21, kMany, kMany, truth));
    std::printf("image %.2f: %.3f, depth %.2f: %.3f, lines %.2f: %.3f\n", truth.image, shown.image,
                truth.depth, shown.depth, truth.lines, shown.lines);
    expect_about(shown, truth, kMany, 0.03);
  }
}

TEST(ResidualScales, AreRobustToWrongMatches) {
  for (const NoiseScales& truth : {NoiseScales{1, 1, 1}, NoiseScales{1, 0.25, 2}}) {
    const NoiseScales shown = shown_by(simulate(22, kMany, kMany, truth, 0.2));
    std::printf("with outliers: image %.2f: %.3f, depth %.2f: %.3f, lines %.2f: %.3f\n", truth.image,
                shown.image, truth.depth, shown.depth, truth.lines, shown.lines);
    expect_about(shown, truth, 0.8 * kMany, 0.05);
  }
}

TEST(ResidualScales, AreOneForTooFewFeatures) {
  const NoiseScales truth{0.1, 0.1, 0.1};
  const NoiseScales few = shown_by(simulate(23, 11, 11, truth));
  EXPECT_EQ(few.image, 1);
  EXPECT_EQ(few.depth, 1);
  EXPECT_EQ(few.lines, 1);
  const NoiseScales enough = shown_by(simulate(23, 12, 12, truth));
  EXPECT_LT(enough.image, 0.5);
  EXPECT_LT(enough.depth, 0.5);
  EXPECT_LT(enough.lines, 0.5);
  // The kinds are counted separately. Residuals that are too large or NaN are not counted.
  const NoiseScales points_only = shown_by(simulate(23, 40, 11, truth));
  EXPECT_LT(points_only.image, 0.5);
  EXPECT_EQ(points_only.lines, 1);
  SimulatedPair pair = simulate(23, 12, 12, truth);
  pair.points_current[4].p.x() += 1;
  pair.lines_current[4].a.x() = std::nan("");
  const NoiseScales one_less = shown_by(pair);
  EXPECT_EQ(one_less.image, 1);
  EXPECT_EQ(one_less.depth, 1);
  EXPECT_EQ(one_less.lines, 1);
}

TEST(ResidualScales, ReserveEnoughScratchAndReleaseIt) {
  Limits limits;
  limits.keypoints = 300;
  limits.segments = 100;
  Arena sizer = Arena::counting();
  reserve_noise_learning(sizer, limits);
  const SimulatedPair pair = simulate(24, limits.keypoints, limits.segments, {});
  Bench bench;
  bench.load(pair);
  std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
  Arena scratch(memory);
  const NoiseScales shown =
      residual_scales(Pinhole{}, bench.points.back(), bench.lines.back(), pair.truth, scratch);
  EXPECT_FALSE(scratch.exhausted());
  EXPECT_EQ(scratch.used(), 0u);
  EXPECT_NE(shown.image, 1);
  EXPECT_NE(shown.lines, 1);
}

TEST(Learning, MovesByItsRate) {
  NoiseConfig config;
  config.learning_rate = 0.1;
  NoiseScales scales{1, 0.5, 2};
  learn(config, {2, 1, 0.5}, scales);
  EXPECT_NEAR(scales.image, 1.1, 1e-15);
  EXPECT_EQ(scales.depth, 0.5);
  EXPECT_NEAR(scales.lines, 1.9, 1e-15);
  config.learning_rate = 0;
  const NoiseScales before = scales;
  learn(config, {3, 0.3, 2}, scales);
  EXPECT_EQ(scales.image, before.image);
  EXPECT_EQ(scales.depth, before.depth);
  EXPECT_EQ(scales.lines, before.lines);
}

TEST(Learning, OneFrameCountsAtMostFourfold) {
  NoiseConfig config;
  config.learning_rate = 0.2;
  NoiseScales scales;
  learn(config, {1e9, 0, 4.001}, scales);
  EXPECT_NEAR(scales.image, 1 + 0.2 * 3, 1e-15);
  EXPECT_NEAR(scales.depth, 1 - 0.2 * 0.75, 1e-15);
  EXPECT_NEAR(scales.lines, 1 + 0.2 * 3, 1e-15);
}

TEST(Learning, StaysWithinItsBounds) {
  NoiseConfig config;
  config.learning_rate = 0.5;
  NoiseScales scales;
  for (int i = 0; i < 200; ++i) {
    learn(config, {100, 0, 1}, scales);
    ASSERT_LE(scales.image, 25);
    ASSERT_GE(scales.depth, 0.04);
  }
  EXPECT_EQ(scales.image, 25);
  EXPECT_EQ(scales.depth, 0.04);
  EXPECT_EQ(scales.lines, 1);
  // The scales return from their bounds.
  learn(config, {0.5, 2, 1}, scales);
  EXPECT_LT(scales.image, 25);
  EXPECT_GT(scales.depth, 0.04);
}

// Estimates of the nuisance parameters as a frame gives them: drawn with the true SD, observed with noise,
// and shrunk towards the prior accordingly.
TEST(Learning, SettlesAtTheTrueSizeOfNuisanceParameters) {
  NoiseConfig config;
  CameraModel camera;
  camera.readout_s = 0.03;
  Gaussian gaussian(7);
  // True SDs far smaller and far larger than the initial one, observed with little and with much noise.
  for (const double truth : {0.2, 2.5})
    for (const double seen_with : {0.5, 2.0}) {
      NoiseScales scales;
      double mean_angular_rate = 0;
      double mean_depth = 0;
      constexpr int kFrames = 4000;
      for (int frame = 0; frame < kFrames; ++frame) {
        const NuisanceParameters prior(Exposure(camera, Vector6::Zero(), 0), std::sqrt(scales.angular_rate),
                                       std::sqrt(scales.shared_depth));
        NuisanceEstimate estimate;
        for (int k = 0; k < NuisanceParameters::kCount; ++k) {
          const double variance = prior.sigma(k) * prior.sigma(k);
          const double noise = seen_with * truth;
          const double gain = variance / (variance + noise * noise);
          estimate.value[k] = gain * (truth * gaussian() + noise * gaussian());
          estimate.variance[k] = (1 - gain) * variance;
        }
        NoiseScales shown;
        note_nuisance(prior, estimate, shown);
        learn(config, shown, scales);
        if (frame < kFrames / 2) continue;
        mean_angular_rate += 2 * scales.angular_rate / kFrames;
        mean_depth += 2 * scales.shared_depth / kFrames;
      }
      EXPECT_NEAR(std::sqrt(mean_angular_rate) / truth, 1, 0.25) << truth << ", " << seen_with;
      EXPECT_NEAR(std::sqrt(mean_depth) / truth, 1, 0.25) << truth << ", " << seen_with;
    }
}

TEST(Learning, AbsentNuisanceParametersGiveOne) {
  NoiseScales shown;
  note_nuisance(NuisanceParameters{}, {}, shown);
  EXPECT_EQ(shown.angular_rate, 1);
  EXPECT_EQ(shown.shared_depth, 1);
}

TEST(Learning, SettlesAtTheTruth) {
  // Covariances include the scales learnt so far, as in the odometry; the residuals show only the remaining
  // factor.
  const NoiseScales truth{2, 0.25, 3};
  NoiseConfig config;
  NoiseScales scales{1, 1, 1};
  for (std::uint64_t frame = 0; frame < 80; ++frame) {
    const NoiseScales left{truth.image / scales.image, truth.depth / scales.depth,
                           truth.lines / scales.lines};
    learn(config, shown_by(simulate(100 + frame, 200, 60, left)), scales);
  }
  // The learning rate averages over about 20 frames.
  EXPECT_NEAR(scales.image / truth.image, 1, 0.15);
  EXPECT_NEAR(scales.depth / truth.depth, 1, 0.2);
  EXPECT_NEAR(scales.lines / truth.lines, 1, 0.2);
}

}  // namespace
}  // namespace plvo
