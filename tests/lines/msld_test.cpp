// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/msld.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "msld_reference.hpp"
#include "picture_scene.hpp"

namespace plvo {
namespace {

using test::PictureScene;
using test::ScenePicture;

// Squared distance in units of the norm of one half: 0 for equal descriptors, 4 for orthogonal ones.
double distance(const LineDescriptor& a, const LineDescriptor& b) {
  return descriptor_distance(a, b) / (255.0 * 255.0);
}

template <typename Check>
void for_each_border(const PictureScene& scene, const Matrix3& H, const Check& check) {
  int count = 0;
  for (const Segment& s : scene.borders(H))
    if (s.length_px() > 10) {
      check(s);
      ++count;
    }
  EXPECT_GT(count, 5);
}

TEST(Msld, AgreesWithTheReference) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const PictureScene scene(seed);
    const ScenePicture picture = scene.render(Matrix3::Identity(), test::as_it_is, 2, seed);
    double worst = 0;
    for_each_border(scene, Matrix3::Identity(), [&](const Segment& s) {
      const LineDescriptor fast = describe_segment(picture.view(), 1, s);
      const std::vector<double> slow = reference::msld(picture.view(), 1, s);
      double squared = 0;
      for (std::size_t k = 0; k < slow.size(); ++k) squared += std::pow(fast.value[k] / 255.0 - slow[k], 2);
      worst = std::fmax(worst, squared);
    });
    EXPECT_LT(worst,
              0.003);  // rounding of positions and of the result; different segments are about 1 apart
  }
}

TEST(Msld, HalvesHaveUnitNorm) {
  const PictureScene scene(4);
  const ScenePicture picture = scene.render(Matrix3::Identity(), test::as_it_is);
  for_each_border(scene, Matrix3::Identity(), [&](const Segment& s) {
    const LineDescriptor d = describe_segment(picture.view(), 1, s);
    for (const std::size_t half : {std::size_t{0}, kMsldLength / 2}) {
      double squared = 0;
      for (std::size_t k = half; k < half + kMsldLength / 2; ++k) squared += d.value[k] * d.value[k];
      EXPECT_NEAR(std::sqrt(squared), 255, 3);
    }
  });
}

TEST(Msld, IsInvariantToLinearChangesOfLight) {
  const PictureScene scene(5);
  const ScenePicture plain = scene.render(Matrix3::Identity(), test::as_it_is);
  const auto worst = [&](const auto& light) {
    const ScenePicture lit = scene.render(Matrix3::Identity(), light);
    double w = 0;
    for_each_border(scene, Matrix3::Identity(), [&](const Segment& s) {
      w = std::fmax(w, distance(describe_segment(plain.view(), 1, s), describe_segment(lit.view(), 1, s)));
    });
    return w;
  };
  EXPECT_LT(worst([](double g, int, int) { return g + 25; }), 1e-3);
  EXPECT_LT(worst([](double g, int, int) { return 0.6 * g; }),
            0.04);  // rounding to whole grey levels remains
  EXPECT_LT(worst([](double g, int, int) { return 0.5 * g + 60; }), 0.05);
  // Light that falls by a factor of three from left to right is only approximately linear.
  EXPECT_LT(worst([](double g, int x, int) { return g * (1 - x / 480.0); }), 0.15);
}

TEST(Msld, IsInvariantToAQuarterTurn) {
  Matrix3 quarter;  // world = (y + 40, 279 − x): an exact quarter turn of the pixels
  quarter << 0, 1, 40, -1, 0, 279, 0, 0, 1;
  int compared = 0;
  for (const std::uint64_t seed : {6u, 7u, 8u, 9u}) {
    const PictureScene scene(seed);
    const ScenePicture upright = scene.render(Matrix3::Identity(), test::as_it_is);
    const ScenePicture turned = scene.render(quarter, test::as_it_is);
    const std::vector<Segment> a = scene.borders(Matrix3::Identity()), b = scene.borders(quarter);
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (a[k].length_px() < 10 || b[k].length_px() < 10) continue;
      const auto whole = [&](const Segment& s) {  // whether the region lies inside the image
        const Vector2 m = s.middle();
        const double r = 0.5 * s.length_px() + 15;
        return m.x() > r && m.y() > r && m.x() < 319 - r && m.y() < 239 - r;
      };
      if (!whole(a[k]) || !whole(b[k])) continue;
      EXPECT_LT(distance(describe_segment(upright.view(), 1, a[k]), describe_segment(turned.view(), 1, b[k])),
                0.05);
      ++compared;
    }
  }
  EXPECT_GT(compared, 10);
}

TEST(Msld, AcceptsSegmentsAcrossTheBordersOfTheImage) {
  const PictureScene scene(7);
  const ScenePicture picture = scene.render(Matrix3::Identity(), test::as_it_is);
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    Segment s;
    s.a = {400 * random.uniform() - 40, 320 * random.uniform() - 40};
    s.b = {400 * random.uniform() - 40, 320 * random.uniform() - 40};
    const std::vector<double> slow = reference::msld(picture.view(), 1, s);
    const LineDescriptor fast = describe_segment(picture.view(), 1, s);
    double squared = 0;
    for (std::size_t k = 0; k < slow.size(); ++k) squared += std::pow(fast.value[k] / 255.0 - slow[k], 2);
    EXPECT_LT(squared, 0.02);
  }
}

TEST(Msld, ReturnsZeroForAFlatImage) {
  const std::vector<std::uint8_t> flat(64 * 64, 90);
  Segment s;
  s.a = {10, 10};
  s.b = {50, 40};
  const LineDescriptor zero;
  EXPECT_EQ(describe_segment({flat.data(), 64, 64, 64}, 1, s).value, zero.value);
  s.b = s.a;
  EXPECT_EQ(describe_segment({flat.data(), 64, 64, 64}, 1, s).value, zero.value);
}

}  // namespace
}  // namespace plvo
