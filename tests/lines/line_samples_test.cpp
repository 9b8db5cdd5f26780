// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line_samples.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "depth_holes.hpp"
#include "depth_picture.hpp"
#include "line_scene.hpp"

namespace plvo {
namespace {

Segment segment(double ax, double ay, double bx, double by) {
  Segment s;
  s.a = {ax, ay};
  s.b = {bx, by};
  return s;
}

constexpr SampleOptions kPaper{1, 0};

TEST(LineSamples, SpacingOfOnePixelGivesTheCountOfThePaper) {
  EXPECT_EQ(sample_count(segment(0, 0, 1.9, 0), kPaper), 0);
  EXPECT_EQ(sample_count(segment(0, 0, 20.7, 0), kPaper), 20);
  EXPECT_EQ(sample_count(segment(0, 0, 60, 80), kPaper), 100);
  EXPECT_EQ(sample_count(segment(0, 0, 600, 80), kPaper), 100);
}

TEST(LineSamples, WiderSpacingTakesFewerSamplesDownToTheMinimum) {
  EXPECT_EQ(sample_count(segment(0, 0, 1.9, 0), {3, 0}), 0);
  EXPECT_EQ(sample_count(segment(0, 0, 12.7, 0), {3, 0}), 12);
  EXPECT_EQ(sample_count(segment(0, 0, 30, 40), {3, 0}), kEnoughSamples);
  EXPECT_EQ(sample_count(segment(0, 0, 60, 80), {3, 0}), 33);
  EXPECT_EQ(sample_count(segment(0, 0, 600, 80), {3, 0}), 100);
}

TEST(LineSamples, AreEvenlySpacedFromEndToEnd) {
  const Segment s = segment(10, 20, 70, 100);
  LineSamples samples;
  std::vector<Vector2> asked;
  sample_segment(s, DepthNoise{}, kPaper, test::DepthFunction{[&](int x, int y) {
                   asked.emplace_back(x, y);
                   return 2.0;
                 }},
                 samples);
  ASSERT_EQ(samples.count, 100);
  EXPECT_EQ(samples.asked, 100);
  EXPECT_EQ(asked.front(), s.a);
  EXPECT_EQ(asked.back(), s.b);
  for (std::size_t i = 1; i < 100; ++i)
    EXPECT_NEAR(samples.sample[i].t_px - samples.sample[i - 1].t_px, 100.0 / 99, 1e-9);
  EXPECT_NEAR(samples.sample[0].t_px, -50, 1e-9);
  EXPECT_DOUBLE_EQ(samples.sample[0].sigma_d_m, DepthNoise{}.sigma(2.0));
}

TEST(LineSamples, OmitsSamplesWithoutDepth) {
  LineSamples samples;
  sample_segment(segment(0, 0, 50, 0), DepthNoise{}, kPaper,
                 test::DepthFunction{[](int x, int) { return x < 20 ? 0.0 : 1.0; }}, samples);
  EXPECT_EQ(samples.asked, 50);
  EXPECT_EQ(samples.count, 30);
}

TEST(LineSamples, SigmaGrowsWithTheSlopeAcrossTheSegment) {
  DepthNoise noise;
  noise.registration_px = 2;
  LineSamples samples;
  const test::DepthFunction slope{[](int, int y) { return 2 + 0.01 * y; }};
  sample_segment(segment(0, 0, 50, 0), noise, {1, 3}, slope, samples);
  EXPECT_NEAR(samples.sample[10].sigma_d_m, std::sqrt(noise.sigma(2) * noise.sigma(2) + 0.02 * 0.02), 1e-6);
  sample_segment(segment(0, 0, 0, 50), noise, {1, 3}, slope, samples);
  EXPECT_DOUBLE_EQ(samples.sample[0].sigma_d_m, noise.sigma(2));
}

// Every sample of a segment on a holed wall has its depth, whatever its direction.
TEST(LineSamples, HolesHaveTheDepthAroundThem) {
  constexpr int kSide = 80;
  for (const test::HolePattern& pattern : test::kHolePatterns) {
    const auto wall_m = [](double x, double y) { return 1 / (0.5 + 0.001 * x - 0.0005 * y); };
    const test::DepthPicture wall(kSide, kSide,
                                  [&](int x, int y) { return pattern.missing(x, y) ? 0.0 : wall_m(x, y); });
    for (const Segment& s : {segment(10, 40, 70, 40), segment(40, 10, 40, 70), segment(11, 12, 66, 70)}) {
      LineSamples samples;
      sample_segment(s, DepthNoise{}, {3, 3}, wall.sampler(), samples);
      EXPECT_GE(samples.count, 0.95 * samples.asked) << pattern.name;
      for (const LineSample& sample : samples.with_depth()) {
        const Vector2 p = 0.5 * (s.a + s.b) + sample.t_px * s.direction();
        ASSERT_NEAR(sample.depth_m, wall_m(p.x(), p.y()), 0.02) << pattern.name;
      }
    }
  }
}

SurfaceReading read(std::array<float, 7> profile) { return nearer_surface(profile, DepthNoise{}); }

TEST(NearerSurface, FollowsTheRule) {
  // One surface: the reading under the segment counts, though a slope makes another one nearer.
  EXPECT_FLOAT_EQ(static_cast<float>(read({2.00f, 2.01f, 2.02f, 2.03f, 2.04f, 2.05f, 2.06f}).depth_m), 2.03f);
  EXPECT_FALSE(read({2.00f, 2.01f, 2.02f, 2.03f, 2.04f, 2.05f, 2.06f}).mixed);
  // The depth image is displaced, so that the background lies under the segment: the reading of the nearer
  // surface that is closest to the segment counts.
  EXPECT_FLOAT_EQ(static_cast<float>(read({1.01f, 1.02f, 3, 3, 3, 3, 3}).depth_m), 1.02f);
  EXPECT_TRUE(read({1.01f, 1.02f, 3, 3, 3, 3, 3}).mixed);
  EXPECT_FLOAT_EQ(static_cast<float>(read({3, 3, 3, 3, 3, 3, 1.01f}).depth_m), 1.01f);
  // The nearer surface lies under the segment.
  EXPECT_FLOAT_EQ(static_cast<float>(read({3, 3, 1.03f, 1.02f, 1.01f, 1.0f, 1.0f}).depth_m), 1.02f);
  // A single wrong reading in front of one surface is not a surface.
  EXPECT_FLOAT_EQ(static_cast<float>(read({3, 3, 3, 3, 1.5f, 3, 3}).depth_m), 3);
  EXPECT_FLOAT_EQ(static_cast<float>(read({3, 3, 3, 1.5f, 3, 3, 3}).depth_m), 3);
  // A shadow: readings of the background are missing beside the nearer surface.
  EXPECT_FLOAT_EQ(static_cast<float>(read({1, 1, 1, 0, 0, 0, 0}).depth_m), 1);
  EXPECT_TRUE(read({1, 1, 1, 0, 0, 0, 0}).mixed);
  EXPECT_FLOAT_EQ(static_cast<float>(read({0, 0, 0, 0, 0, 0, 0}).depth_m), 0);
  EXPECT_FLOAT_EQ(static_cast<float>(read({0, 0, 0, 2, 0, 0, 0}).depth_m), 2);
}

TEST(NearerSurface, IsTheReadingItselfWithoutReach) {
  const std::array<float, 1> one{1.5f};
  EXPECT_EQ(nearer_surface(one, DepthNoise{}).depth_m, 1.5);
  EXPECT_FALSE(nearer_surface(one, DepthNoise{}).mixed);
}

}  // namespace
}  // namespace plvo
