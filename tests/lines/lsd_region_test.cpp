// SPDX-License-Identifier: Apache-2.0
// The integer stages of the segment detector, each against a slow and obvious version in floating point.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>
#include <vector>

#include "line_picture.hpp"
#include "plvo/lines/lsd/line_validation.hpp"
#include "plvo/lines/lsd/wedge.hpp"

namespace plvo::lsd {
namespace {

constexpr double kDegree = kPi / 180;

double angle_of(Direction d) { return std::atan2(d.y, d.x); }

double angle_between(double a, double b) { return std::abs(std::remainder(a - b, 2 * kPi)); }

struct Field {
  std::vector<std::uint8_t> pixels;
  std::vector<std::byte> memory;
  Arena arena;
  LevelLineField field;
  std::span<Pixel> storage;
  int width;
  int height;

  Field(int w, int h, std::vector<std::uint8_t> image)
      : pixels(std::move(image)), memory(1 << 21), arena(memory), width(w), height(h) {
    field = carve_field(arena, w, h);
    storage = arena.take<Pixel>("region", static_cast<std::size_t>(w * h));
    compute_field({pixels.data(), w, h, w}, field, storage);
  }
  int at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
};

// Polygons under noise, twice smoothed like a pyramid level: regions of every size.
Field busy_field(std::uint64_t seed) {
  Random random(seed);
  test::Picture picture(160, 120, 90);
  for (int i = 0; i < 6; ++i) {
    const Vector2 centre(160 * random.uniform(), 120 * random.uniform());
    test::fill_polygon(picture,
                       test::regular_polygon(centre, 3 + i, 15 + 25 * random.uniform(), 7 * random.uniform()),
                       255 * random.uniform());
  }
  return {160, 120, test::expose(picture, 3, random)};
}

TEST(LevelLineField, PolarGradientIsAtan2AndHypot) {
  for (int gx = -510; gx <= 510; gx += 7) {
    for (int gy = -510; gy <= 510; ++gy) {
      if (gx == 0 && gy == 0) continue;
      const PolarGradient polar = polar_gradient(gx, gy);
      ASSERT_LE(angle_between(angle_of(polar.direction), std::atan2(gy, gx)), 0.032 * kDegree)
          << gx << " " << gy;
      ASSERT_NEAR(std::hypot(polar.direction.x, polar.direction.y), 16384, 2);
      ASSERT_NEAR(polar.magnitude, 16 * std::hypot(gx, gy), 1 + 0.016 * std::hypot(gx, gy));
    }
  }
}

TEST(LevelLineField, IsTheTwoByTwoGradientAboveTheQuantisationNoise) {
  const Field f = busy_field(1);
  std::size_t directed = 0;
  for (int y = -1; y <= f.field.height; ++y) {
    for (int x = -1; x <= f.field.width; ++x) {
      const std::size_t i = f.field.index(x, y);
      const bool border = x < 0 || y < 0 || x == f.field.width || y == f.field.height;
      double gx = 0, gy = 0;
      if (!border) {
        gx = 0.5 * (f.at(x + 1, y) - f.at(x, y) + f.at(x + 1, y + 1) - f.at(x, y + 1));
        gy = 0.5 * (f.at(x, y + 1) - f.at(x, y) + f.at(x + 1, y + 1) - f.at(x + 1, y));
      }
      if (std::hypot(gx, gy) <= std::sqrt(2.0) / std::sin(22.5 * kDegree)) {
        ASSERT_EQ(f.field.state[i], kUsed);
        ASSERT_TRUE(f.field.direction[i].x == 0 && f.field.direction[i].y == 0);
        continue;
      }
      ++directed;
      ASSERT_EQ(f.field.state[i], 0);
      ASSERT_LE(angle_between(angle_of(f.field.direction[i]), std::atan2(gy, gx)), 0.032 * kDegree);
    }
  }
  ASSERT_GT(directed, 1000U);
  ASSERT_EQ(f.field.seed_count, directed);
}

TEST(LevelLineField, SeedsComeStrongestFirstAndEachOnce) {
  const Field f = busy_field(2);
  std::set<std::pair<int, int>> seen;
  int before = 1 << 20;
  for (const Pixel& seed : f.field.seeds.first(f.field.seed_count)) {
    const int bin = f.field.magnitude[f.field.index(seed.x, seed.y)] / 12;
    EXPECT_LE(bin, before);
    before = bin;
    EXPECT_TRUE(seen.insert({seed.x, seed.y}).second);
  }
}

// Section 2.3 in angles, as the paper words it, but that the region's direction is renewed only when the
// region has grown by an eighth.
std::vector<std::pair<int, int>> grow_by_angles(const LevelLineField& field, std::vector<bool>& used,
                                                Pixel seed, bool& too_close_to_call) {
  std::vector<std::pair<int, int>> region{{seed.x, seed.y}};
  used[field.index(seed.x, seed.y)] = true;
  double sum_x = std::cos(angle_of(field.direction[field.index(seed.x, seed.y)]));
  double sum_y = std::sin(angle_of(field.direction[field.index(seed.x, seed.y)]));
  double direction = 0;
  std::size_t renew = 1;
  for (std::size_t next = 0; next < region.size(); ++next) {
    if (region.size() >= renew) {
      direction = std::atan2(sum_y, sum_x);
      renew = region.size() + region.size() / 8 + 1;
    }
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const int x = region[next].first + i;
        const int y = region[next].second + j;
        const std::size_t at = field.index(x, y);
        if (used[at]) continue;
        const double angle = angle_of(field.direction[at]);
        const double difference = angle_between(angle, direction);
        if (std::abs(difference - 22.5 * kDegree) < 3e-4) too_close_to_call = true;
        if (difference > 22.5 * kDegree) continue;
        used[at] = true;
        region.push_back({x, y});
        sum_x += std::cos(angle);
        sum_y += std::sin(angle);
      }
    }
  }
  return region;
}

TEST(Region, GrowsAsWithAngles) {
  int compared = 0;
  for (std::uint64_t seed = 3; seed < 9; ++seed) {
    Field f = busy_field(seed);
    std::vector<bool> used(f.field.state.size());
    for (std::size_t i = 0; i < used.size(); ++i) used[i] = (f.field.state[i] & kUsed) != 0;
    for (const Pixel& start : f.field.seeds.first(f.field.seed_count)) {
      if (used[f.field.index(start.x, start.y)]) continue;
      bool too_close_to_call = false;
      const auto expected = grow_by_angles(f.field, used, start, too_close_to_call);
      if (too_close_to_call) break;  // the two may differ from here on, rightly
      const Region region = grow(f.field, start, kTau, f.storage);
      ASSERT_EQ(region.pixels.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(region.pixels[i].x, expected[i].first);
        ASSERT_EQ(region.pixels[i].y, expected[i].second);
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

// A clean edge has no spread at all: what tighten() asks for then is the least tolerance.
TEST(Region, OneDirectionHoldsTogetherAtTheLeastTolerance) {
  constexpr int kSide = 40;
  for (const bool upright : {true, false}) {
    std::vector<std::uint8_t> image;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) image.push_back((upright ? x : y) < kSide / 2 ? 40 : 200);
    Field f(kSide, kSide, image);
    ASSERT_EQ(f.field.seed_count, kSide - 1U);
    EXPECT_EQ(grow(f.field, f.field.seeds[0], kLeastTolerance, f.storage).pixels.size(), kSide - 1U);
  }
}

TEST(Region, APixelIsAddedSoManyTimesAndNoMore) {
  Field f = busy_field(4);
  const Pixel seed = f.field.seeds[0];
  for (int i = 0; i < 20; ++i) {
    const Region region = grow(f.field, seed, kTau, f.storage);
    if (i < kMaxGrowths) {
      EXPECT_GT(region.pixels.size(), 3U);
    } else {
      EXPECT_EQ(region.pixels.size(), 1U);  // all its neighbours have had their turns
    }
    release(f.field, region.pixels);
  }
}

TEST(Rectangle, HasTheMomentsOfItsRegionAndHoldsIt) {
  Field f = busy_field(6);
  int compared = 0;
  for (const Pixel& start : f.field.seeds.first(f.field.seed_count)) {
    if ((f.field.state[f.field.index(start.x, start.y)] & kUsed) != 0) continue;
    const Region region = grow(f.field, start, kTau, f.storage);
    const Rectangle r = fit_rectangle(f.field, region);
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double mass = 0;
    for (const Pixel& p : region.pixels) {
      const double w = f.field.magnitude[f.field.index(p.x, p.y)];
      centre += w * Eigen::Vector2d(p.x, p.y);
      mass += w;
      EXPECT_TRUE(r.along(p.x, p.y) >= r.along_min && r.along(p.x, p.y) <= r.along_max);
      EXPECT_TRUE(r.across(p.x, p.y) >= r.across_min && r.across(p.x, p.y) <= r.across_max);
    }
    centre /= mass;
    EXPECT_NEAR(r.x_q8 / 256.0, centre.x(), 0.003);
    EXPECT_NEAR(r.y_q8 / 256.0, centre.y(), 0.003);
    EXPECT_GE(r.width_q8(), 256);
    EXPECT_GE(static_cast<double>(region.sum_y) * r.dx - static_cast<double>(region.sum_x) * r.dy, 0);
    if (region.pixels.size() < 5) continue;
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    for (const Pixel& p : region.pixels) {
      const Eigen::Vector2d d = Eigen::Vector2d(p.x, p.y) - centre;
      moments += static_cast<double>(f.field.magnitude[f.field.index(p.x, p.y)]) * d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
    solver.computeDirect(moments);
    const Eigen::Vector2d axis = solver.eigenvectors().col(1);
    if (solver.eigenvalues()[1] < 1.2 * solver.eigenvalues()[0]) continue;
    EXPECT_NEAR(std::abs(axis.x() * r.dx + axis.y() * r.dy) / 16384, 1, 1e-4);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

TEST(Rectangle, VisitsExactlyThePixelsInside) {
  const Field f = busy_field(7);
  Random random(11);
  for (int trial = 0; trial < 400; ++trial) {
    Rectangle r;
    const double angle = trial < 16 ? trial * kPi / 8 : 2 * kPi * random.uniform();
    r.x_q8 = static_cast<std::int32_t>(160 * 256 * random.uniform());
    r.y_q8 = static_cast<std::int32_t>(120 * 256 * random.uniform());
    r.dx = static_cast<std::int32_t>(std::lround(16384 * std::cos(angle)));
    r.dy = static_cast<std::int32_t>(std::lround(16384 * std::sin(angle)));
    r.along_min = -static_cast<std::int32_t>(256 * 60 * random.uniform());
    r.along_max = static_cast<std::int32_t>(256 * 60 * random.uniform());
    r.across_min = -static_cast<std::int32_t>(256 * 6 * random.uniform());
    r.across_max = static_cast<std::int32_t>(256 * 6 * random.uniform());
    std::vector<std::pair<int, int>> expected;
    for (int y = 0; y < f.field.height; ++y) {
      for (int x = 0; x < f.field.width; ++x) {
        const std::int32_t l = r.along(x, y);
        const std::int32_t t = r.across(x, y);
        if (l >= r.along_min && l <= r.along_max && t >= r.across_min && t <= r.across_max)
          expected.push_back({x, y});
      }
    }
    std::vector<std::pair<int, int>> visited;
    for_each_row(f.field, r, [&](int y, int first, int last) {
      for (int x = first; x <= last; ++x) visited.push_back({x, y});
    });
    ASSERT_EQ(visited, expected);
  }
}

TEST(Wedge, HoldsWhatIsWithinItsTolerance) {
  Random random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const double angle = 2 * kPi * random.uniform();
    const double length = trial % 3 == 0 ? 16384 : 16384 * 1000 * random.uniform() + 8192;
    const Wedge wedge =
        make_wedge(std::llround(length * std::cos(angle)), std::llround(length * std::sin(angle)), kTau);
    const double spread = trial % 2 == 0 ? kPi : 0.4;
    const double other = angle + spread * (2 * random.uniform() - 1);
    const Direction d{static_cast<std::int16_t>(std::lround(16384 * std::cos(other))),
                      static_cast<std::int16_t>(std::lround(16384 * std::sin(other)))};
    const double off = angle_between(other, angle);
    if (wedge.holds(d))
      EXPECT_LT(off, 22.5 * kDegree + 0.016 * kDegree);
    else
      EXPECT_GT(off, 22.5 * kDegree - 0.016 * kDegree);
  }
  EXPECT_FALSE(make_wedge(16384, 0, kTau).holds(Direction{0, 0}));
}

// Four at once, and what is left of a row.
TEST(Wedge, CountsInARowWhatItHoldsOneByOne) {
  Random random(4);
  std::vector<Direction> row(40);
  for (int trial = 0; trial < 2000; ++trial) {
    for (Direction& d : row) {
      const double angle = 2 * kPi * random.uniform();
      d = {static_cast<std::int16_t>(std::lround(16384 * std::cos(angle))),
           static_cast<std::int16_t>(std::lround(16384 * std::sin(angle)))};
      if (random.uniform() < 0.2) d = {0, 0};
    }
    const double angle = 2 * kPi * random.uniform();
    const Wedge wedge =
        make_wedge(std::llround(16384 * std::cos(angle)), std::llround(16384 * std::sin(angle)), kTau);
    const int first = static_cast<int>(18 * random.uniform());
    const int last = first + static_cast<int>(18 * random.uniform());
    int held = 0;
    for (int x = first; x <= last; ++x) held += wedge.holds(row[static_cast<std::size_t>(x)]) ? 1 : 0;
    ASSERT_EQ(count_held(wedge, row.data(), first, last), held);
  }
}

TEST(Validation, CountsWhatTheRectangleHolds) {
  Field f = busy_field(8);
  const FalseAlarms alarms(f.width, f.height);
  int meaningful = 0;
  for (const Pixel& start : f.field.seeds.first(f.field.seed_count)) {
    if ((f.field.state[f.field.index(start.x, start.y)] & kUsed) != 0) continue;
    const Region region = grow(f.field, start, kTau, f.storage);
    Rectangle r = fit_rectangle(f.field, region);
    if (region.pixels.size() < 10 || !is_dense(r, region.pixels.size())) continue;
    const double found = meaningfulness(f.field, alarms, r);
    const Wedge across = make_wedge(-r.dy, r.dx, kTau);
    int n = 0, k = 0;
    for (int y = 0; y < f.field.height; ++y) {
      for (int x = 0; x < f.field.width; ++x) {
        const std::int32_t l = r.along(x, y);
        const std::int32_t t = r.across(x, y);
        if (l < r.along_min || l > r.along_max || t < r.across_min || t > r.across_max) continue;
        ++n;
        k += across.holds(f.field.direction[f.field.index(x, y)]) ? 1 : 0;
      }
    }
    EXPECT_EQ(found, alarms.meaningfulness(n, k));
    meaningful += found >= 0 ? 1 : 0;
  }
  EXPECT_GE(meaningful, 5);
}

}  // namespace
}  // namespace plvo::lsd
