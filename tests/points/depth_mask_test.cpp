// SPDX-License-Identifier: Apache-2.0
// Compares the depth mask of a keypoint with its definition: a pixel belongs to the mask when every pixel of
// the level within two pixels has a depth that differs by less than 6 %, or has no depth and is surrounded by
// such pixels: each square of 3×3 pixels that contains it contains one of them.
#include "plvo/points/depth_mask.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "depth_holes.hpp"
#include "plvo/base/random.hpp"
#include "whole_window.hpp"

namespace plvo {
namespace {

using test::HolePattern;
using test::kHolePatterns;
using test::kWholeWindow;

constexpr int kSceneWidth = 96;
constexpr int kSceneHeight = 80;
constexpr double kUnit = 0.001;  // m

// A depth image computed by a function of the pixel, in metres, without a lens; 0 is no depth.
struct Scene {
  template <typename Function>
  explicit Scene(Function depth_m) : units(kSceneWidth * kSceneHeight) {
    for (int y = 0; y < kSceneHeight; ++y)
      for (int x = 0; x < kSceneWidth; ++x)
        units[static_cast<std::size_t>(y * kSceneWidth + x)] =
            static_cast<std::uint16_t>(std::floor(depth_m(x, y) / kUnit + 0.5));
  }
  DepthSampler sampler() const {
    return {{units.data(), kSceneWidth, kSceneHeight, kSceneWidth, kUnit}, map, {}};
  }
  double at(int x, int y) const {
    if (x < 0 || y < 0 || x >= kSceneWidth || y >= kSceneHeight) return 0;
    return units[static_cast<std::size_t>(y * kSceneWidth + x)] * kUnit;
  }
  std::vector<std::uint16_t> units;
  UndistortionMap map;
};

Keypoint keypoint_at(double u, double v, int level) {
  Keypoint keypoint;
  keypoint.u = static_cast<float>(u);
  keypoint.v = static_cast<float>(v);
  keypoint.level = static_cast<std::uint8_t>(level);
  return keypoint;
}

// The mask for depth that is exposed with colour.
WindowMask depth_mask_of(const DepthSampler& depth, const Keypoint& keypoint, double depth_m) {
  const Vector2 centre(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v));
  return depth_mask(depth, centre, depth_m, keypoint.level);
}

WindowMask slow_mask(const Scene& scene, const Keypoint& keypoint, double depth_m) {
  constexpr int kRim = 2;
  constexpr int kHole = 1;
  const int step = 1 << keypoint.level;
  // The depth of the pixel of the keypoint's level at this offset in columns and rows from the keypoint. The
  // pixels beside the first that it covers serve where that has none.
  const auto depth = [&](int column, int row) {
    const int x = static_cast<int>(std::floor(static_cast<double>(keypoint.u) + column * step + 0.5));
    const int y = static_cast<int>(std::floor(static_cast<double>(keypoint.v) + row * step + 0.5));
    double found = scene.at(x, y);
    const bool inside = x >= 0 && y >= 0 && x < kSceneWidth && y < kSceneHeight;
    if (step > 1 && inside)
      for (const auto& [right, down] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
        if (found == 0) found = scene.at(x + right, y + down);
    return found;
  };
  const auto own = [&](int column, int row) {
    return std::fabs(depth(column, row) - depth_m) < 0.06 * depth_m;
  };
  // Whether a square of 2 · kHole + 1 pixels around this one contains a pixel of the surface.
  const auto own_near = [&](int column, int row) {
    for (int dy = -kHole; dy <= kHole; ++dy)
      for (int dx = -kHole; dx <= kHole; ++dx)
        if (own(column + dx, row + dy)) return true;
    return false;
  };
  const auto on_surface = [&](int column, int row) {
    if (own(column, row)) return true;
    if (depth(column, row) > 0) return false;
    for (int dy = -kHole; dy <= kHole; ++dy)
      for (int dx = -kHole; dx <= kHole; ++dx)
        if (!own_near(column + dx, row + dy)) return false;
    return true;
  };
  WindowMask mask{};
  for (int r = 0; r < kWindowRows; ++r)
    for (int c = 0; c < kWindowColumns; ++c) {
      bool all = true;
      for (int dy = -kRim; dy <= kRim && all; ++dy)
        for (int dx = -kRim; dx <= kRim && all; ++dx)
          all = on_surface(c - kWindowReach + dx, r - kWindowReach + dy);
      if (all)
        mask[static_cast<std::size_t>(r)] =
            static_cast<std::uint8_t>(mask[static_cast<std::size_t>(r)] | 1 << c);
    }
  return mask;
}

int count(const WindowMask& mask) {
  int n = 0;
  for (const std::uint8_t row : mask)
    for (int c = 0; c < kWindowColumns; ++c) n += row >> c & 1;
  return n;
}

TEST(DepthMask, EqualsItsDefinition) {
  // A slanted edge, a gap without depth along a part of it, single holes, and a slope.
  const Scene scene([](int x, int y) {
    if (x + y / 3 > 55 && x + y / 3 < 59 && y > 30) return 0.0;
    if ((x * 7 + y * 13) % 211 == 0) return 0.0;
    return x + y / 3 < 57 ? 1.0 + 0.004 * x : 1.7 - 0.003 * y;
  });
  const DepthSampler sampler = scene.sampler();
  Random random(3);
  int whole = 0, empty = 0, partly = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    // The centre of the window may be at the border of the image.
    const double u = (kSceneWidth - 1.0) * random.uniform();
    const double v = (kSceneHeight - 1.0) * random.uniform();
    const Keypoint keypoint = keypoint_at(u, v, trial % 3);
    const double depth_m = scene.at(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5));
    if (depth_m == 0) continue;
    const WindowMask mask = depth_mask_of(sampler, keypoint, depth_m);
    ASSERT_EQ(mask, slow_mask(scene, keypoint, depth_m))
        << "u " << u << ", v " << v << ", level " << trial % 3;
    ++(mask == kWholeWindow ? whole : count(mask) == 0 ? empty : partly);
  }
  // Each case occurs.
  EXPECT_GT(whole, 100);
  EXPECT_GT(partly, 100);
  EXPECT_GT(empty, 50);
}

TEST(DepthMask, IsTheWholeWindowFarFromEdges) {
  // The edge is just beyond the window and its margin, which are columns −6 … 5 of the level.
  for (int level : {0, 1, 2}) {
    const int step = 1 << level;
    const int u = 40;
    const Scene scene([&](int x, int) { return x <= u + 5 * step ? 1.0 : 2.0; });
    EXPECT_EQ(depth_mask_of(scene.sampler(), keypoint_at(u, 40, level), 1.0), kWholeWindow) << level;
    // An edge one column nearer removes exactly the last column of the window.
    WindowMask but_last;
    but_last.fill(0x7f);
    EXPECT_EQ(depth_mask_of(scene.sampler(), keypoint_at(u + step, 40, level), 1.0), but_last) << level;
  }
}

TEST(DepthMask, EqualsItsDefinitionWithHoles) {
  Random random(5);
  for (const HolePattern& pattern : kHolePatterns) {
    const Scene scene([&](int x, int y) {
      if (pattern.missing(x, y)) return 0.0;
      return x + y / 3 < 57 ? 1.0 + 0.004 * x : 1.7 - 0.003 * y;
    });
    const DepthSampler sampler = scene.sampler();
    for (int trial = 0; trial < 600; ++trial) {
      const double u = (kSceneWidth - 1.0) * random.uniform();
      const double v = (kSceneHeight - 1.0) * random.uniform();
      const Keypoint keypoint = keypoint_at(u, v, trial % 3);
      const double depth_m = trial % 2 == 0 ? 1.2003 : 1.6003;
      ASSERT_EQ(depth_mask_of(sampler, keypoint, depth_m), slow_mask(scene, keypoint, depth_m))
          << pattern.name << ", u " << u << ", v " << v << ", level " << trial % 3;
    }
  }
}

TEST(DepthMask, IsWholeWhereTheSurfaceSurroundsItsHoles) {
  // The last pattern has holes of 3×3 pixels.
  for (const HolePattern& pattern : std::span(kHolePatterns).first(kHolePatterns.size() - 1)) {
    const Scene wall([&](int x, int y) { return pattern.missing(x, y) ? 0.0 : 1.0; });
    const DepthSampler sampler = wall.sampler();
    int pixels = 0, windows = 0;
    for (const int level : {0, 1})
      for (int v = 26; v < kSceneHeight - 26; ++v)
        for (int u = 26; u < kSceneWidth - 26; ++u, ++windows)
          pixels += count(depth_mask_of(sampler, keypoint_at(u, v, level), 1.0));
    EXPECT_GT(pixels, 0.95 * windows * kWindowColumns * kWindowRows) << pattern.name;
  }
  // A hole of 2×2 pixels is filled; one of 3×3 is not, nor the rim of 2 px around it.
  for (const int side : {2, 3}) {
    const Scene hole(
        [&](int x, int y) { return x >= 38 && y >= 38 && x < 38 + side && y < 38 + side ? 0.0 : 1.0; });
    EXPECT_EQ(count(depth_mask_of(hole.sampler(), keypoint_at(40, 40, 0), 1.0)),
              side == 2 ? kWindowColumns * kWindowRows : kWindowColumns * kWindowRows - 7 * 7);
  }
  const Scene blind([](int, int) { return 0.0; });
  EXPECT_EQ(depth_mask_of(blind.sampler(), keypoint_at(40, 40, 0), 1.0), WindowMask{});
}

// A hole between two surfaces, as in the Kinect's shadow, belongs to neither of them, however narrow it is.
TEST(DepthMask, ExcludesTheShadowBesideAnEdge) {
  constexpr int kLast = 40;  // last column of the nearer surface
  for (const bool combed : {false, true})
    for (int width = 1; width < 9; ++width) {
      const Scene scene([&](int x, int y) {
        if (combed && (x % 2 == 0 || y % 2 == 0)) return 0.0;
        return x <= kLast ? 1.0 : x <= kLast + width ? 0.0 : 2.0;
      });
      for (int u = kLast - 8; u <= kLast + 8; ++u)
        for (const double depth_m : {1.0, 2.0}) {
          const WindowMask mask = depth_mask_of(scene.sampler(), keypoint_at(u, 40, 0), depth_m);
          for (int c = 0; c < kWindowColumns; ++c) {
            const int x = u - kWindowReach + c;
            const bool beside = depth_m == 1.0 ? x > kLast - 2 : x <= kLast + width + 2;
            for (const std::uint8_t row : mask)
              ASSERT_FALSE(beside && (row >> c & 1) != 0) << "column " << x << ", shadow " << width;
          }
        }
    }
}

TEST(DepthMask, ExcludesPixelsOutsideTheImage) {
  // The depth is constant, so the mask excludes only pixels outside the image or within two pixels of its
  // border.
  const Scene wall([](int, int) { return 1.5; });
  for (int level : {0, 1, 2})
    for (int u = 0; u < 7 << level; ++u) {
      const Keypoint keypoint = keypoint_at(u, 40, level);
      ASSERT_EQ(depth_mask_of(wall.sampler(), keypoint, 1.5), slow_mask(wall, keypoint, 1.5))
          << "u " << u << ", level " << level;
    }
}

}  // namespace
}  // namespace plvo
