// SPDX-License-Identifier: Apache-2.0
// Compares each integer stage of the segment detector with a slow reference in floating point.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "line_picture.hpp"
#include "plvo/lines/lsd/angle_range.hpp"
#include "plvo/lines/lsd/line_validation.hpp"
#include "plvo/math/rounding.hpp"

namespace plvo::lsd {
namespace {

constexpr double kDegree = kPi / 180;

double radians(Angle angle) { return angle / kAnglePerRadian; }

double angle_between(double a, double b) { return std::abs(std::remainder(a - b, 2 * kPi)); }

// Distances from the centre of a rectangle along it and across it, in units of 2^-8 pixels.
std::int32_t along(const Rectangle& r, int x, int y) {
  const std::int64_t q22 = std::int64_t{x * 256 - r.x_q8} * r.dx + std::int64_t{y * 256 - r.y_q8} * r.dy;
  return static_cast<std::int32_t>(q22 >> Rectangle::kDirectionBits);
}
std::int32_t across(const Rectangle& r, int x, int y) {
  const std::int64_t q22 = std::int64_t{y * 256 - r.y_q8} * r.dx - std::int64_t{x * 256 - r.x_q8} * r.dy;
  return static_cast<std::int32_t>(q22 >> Rectangle::kDirectionBits);
}

struct Field {
  std::vector<std::uint8_t> pixels;
  std::vector<std::byte> memory;
  Arena arena;
  LevelLineField field;
  std::span<PixelRun> storage;
  int width;
  int height;

  Field(int w, int h, std::vector<std::uint8_t> image)
      : pixels(std::move(image)), memory(1 << 21), arena(memory), width(w), height(h) {
    field = allocate_field(arena, w, h);
    storage = arena.take<PixelRun>("region", static_cast<std::size_t>(w * h));
    compute_field({pixels.data(), w, h, w}, field);
  }
  int at(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
  bool is_open(PixelRun pixel) const { return (field.open()[field.index(pixel)] & pixel.bits) != 0; }
  bool is_open(int x, int y) const { return is_open(piece_of(x, y)); }
  bool is_directed(int x, int y) const {
    const PixelRun run = piece_of(x, y);
    return (field.directed[static_cast<std::size_t>(field.index(run))] & run.bits) != 0;
  }
  Angle angle(int x, int y) const { return field.angles()[field.pixel(x, y)]; }
  int magnitude(int x, int y) const {
    return field.magnitude_and_releases[static_cast<std::size_t>(field.pixel(x, y))] &
           ((1 << LevelLineField::kReleaseBit) - 1);
  }
  static PixelRun piece_of(int x, int y) {
    return {static_cast<std::uint16_t>(y), static_cast<std::uint8_t>(x / kBlockPixels),
            static_cast<std::uint8_t>(1 << x % kBlockPixels)};
  }
  std::span<const PixelRun> seeds() const { return field.seeds.first(field.seed_count); }
};

using Pixels = std::vector<std::pair<int, int>>;  // x, y

void append(PixelRun run, Pixels& pixels) {
  for (int i = 0; i < kBlockPixels; ++i)
    if ((run.bits >> i & 1) != 0) pixels.push_back({run.block * kBlockPixels + i, run.row});
}
Pixels pixels_of(std::span<const PixelRun> runs) {
  Pixels pixels;
  for (const PixelRun run : runs) append(run, pixels);
  return pixels;
}

// Polygons with noise, smoothed twice like a pyramid level, so that regions of every size occur.
Field busy_field(std::uint64_t seed, int width = 160) {
  Random random(seed);
  test::Picture picture(width, 120, 90);
  for (int i = 0; i < 6; ++i) {
    const Vector2 centre(160 * random.uniform(), 120 * random.uniform());
    test::fill_polygon(picture,
                       test::regular_polygon(centre, 3 + i, 15 + 25 * random.uniform(), 7 * random.uniform()),
                       255 * random.uniform());
  }
  return {width, 120, test::expose(picture, 3, random)};
}

TEST(LevelLineField, PolarGradientEqualsAtan2AndHypot) {
  for (int gx = -510; gx <= 510; gx += 7) {
    for (int gy = -510; gy <= 510; ++gy) {
      if (gx == 0 && gy == 0) continue;
      const PolarGradient polar = polar_gradient(gx, gy);
      ASSERT_LE(angle_between(radians(polar.angle), std::atan2(gy, gx)), 0.004 * kDegree) << gx << " " << gy;
      ASSERT_NEAR(polar.magnitude, 8 * std::hypot(gx, gy), 0.51);
    }
  }
}

TEST(LevelLineField, EqualsTheTwoByTwoGradientAboveTheQuantisationNoise) {
  for (const int width : {160, 161, 162, 165, 168}) {  // the rows end at any position in a block
    const Field f = busy_field(1, width);
    std::size_t directed = 0;
    for (int y = 0; y < f.field.height; ++y) {
      for (int x = 0; x < (f.field.stride - 1) * kBlockPixels; ++x) {
        double gx = 0, gy = 0;
        if (x < f.field.width) {
          gx = 0.5 * (f.at(x + 1, y) - f.at(x, y) + f.at(x + 1, y + 1) - f.at(x, y + 1));
          gy = 0.5 * (f.at(x, y + 1) - f.at(x, y) + f.at(x + 1, y + 1) - f.at(x + 1, y));
        }
        const bool strong = std::hypot(gx, gy) > std::sqrt(2.0) / std::sin(22.5 * kDegree);
        ASSERT_EQ(f.is_directed(x, y), strong);
        ASSERT_EQ(f.is_open(x, y), strong);
        if (!strong) continue;
        ++directed;
        ASSERT_LE(angle_between(radians(f.angle(x, y)), std::atan2(gy, gx)), 0.004 * kDegree);
        ASSERT_NEAR(f.magnitude(x, y), 16 * std::hypot(gx, gy), 0.51);
      }
    }
    ASSERT_GT(directed, 1000U);
    ASSERT_EQ(f.field.seed_count, directed);
  }
}

TEST(LevelLineField, HasNoOpenPixelsOutsideTheImage) {
  const Field f = busy_field(2);
  const LevelLineField& field = f.field;
  for (int block = -1; block < field.stride; ++block) {
    EXPECT_EQ(field.open()[field.index(block, -1)], 0);
    EXPECT_EQ(field.open()[field.index(block, field.height)], 0);
  }
  for (int row = 0; row < field.height; ++row) {
    EXPECT_EQ(field.open()[field.index(-1, row)], 0);
    EXPECT_EQ(field.open()[field.index(field.stride - 1, row)], 0);
  }
}

TEST(LevelLineField, SeedsAreOrderedByStrengthAndUnique) {
  const Field f = busy_field(2);
  std::set<std::pair<int, int>> seen;
  int before = 1 << 20;
  for (const auto& [x, y] : pixels_of(f.seeds())) {
    const int bin = f.magnitude(x, y) / 6;
    EXPECT_LE(bin, before);
    before = bin;
    EXPECT_TRUE(seen.insert({x, y}).second);
  }
  EXPECT_EQ(seen.size(), f.field.seed_count);
}

// Grows a region with sets of pixels, block by block.
class SlowRegion {
 public:
  SlowRegion(const Field& f, std::set<std::pair<int, int>>& used, int seed_x, int seed_y)
      : f_(f), used_(used) {
    first_ = middle_ = f.angle(seed_x, seed_y);
    take(seed_x / kBlockPixels, seed_y, {{seed_x, seed_y}});
    for (std::size_t next = 0; next < pieces_.size(); ++next) {
      const Pixels run = pieces_[next];
      for (const auto& [x, y] : run) beyond_first_ += static_cast<Angle>(f_.angle(x, y) - first_);
      size_ += run.size();
      if (size_ >= renew_) renew();
      const int row = run.front().second;
      const int block = run.front().first / kBlockPixels;
      take(block, row - 1, run);
      take(block, row + 1, run);
      for (const int beside : {-1, 1})
        for (const int down : {-1, 0, 1}) take(block + beside, row + down, run);
    }
  }
  const std::vector<Pixels>& runs() const { return pieces_; }

 private:
  bool fits(int x, int y) const {
    if (x < 0 || y < 0 || x >= f_.field.width || y >= f_.field.height || !f_.is_directed(x, y)) return false;
    const auto off = static_cast<Angle>(f_.angle(x, y) - middle_);
    return used_.count({x, y}) == 0 && off >= -kTau && off <= kTau;
  }
  // Takes the pixels of a block row that fit and touch `pixels`, and those that touch them along the row.
  void take(int block, int row, const Pixels& pixels) {
    std::set<int> taken;
    const int begin = block * kBlockPixels, end = begin + kBlockPixels;
    for (const auto& [x, y] : pixels)
      for (int i = std::max(x - 1, begin); i <= std::min(x + 1, end - 1); ++i)
        if (std::abs(y - row) <= 1 && fits(i, row) && (pieces_.size() > 0 || i == x)) taken.insert(i);
    for (int x = begin + 1; x < end; ++x)
      if (taken.count(x - 1) != 0 && fits(x, row)) taken.insert(x);
    for (int x = end - 2; x >= begin; --x)
      if (taken.count(x + 1) != 0 && fits(x, row)) taken.insert(x);
    if (taken.empty()) return;
    pieces_.emplace_back();
    for (const int x : taken) {
      used_.insert({x, row});
      pieces_.back().push_back({x, row});
    }
  }
  void renew() {
    middle_ = static_cast<Angle>(first_ + beyond_first_ / static_cast<int>(size_));
    renew_ = size_ + size_ / 8 + 1;
  }

  const Field& f_;
  std::set<std::pair<int, int>>& used_;
  std::vector<Pixels> pieces_;
  std::size_t size_ = 0, renew_ = 0;
  Angle first_ = 0, middle_ = 0;
  int beyond_first_ = 0;
};

TEST(Region, GrowsLikeTheReference) {
  int compared = 0;
  for (std::uint64_t seed = 3; seed < 9; ++seed) {
    Field f = busy_field(seed, 158 + static_cast<int>(seed));
    std::set<std::pair<int, int>> used;
    for (const PixelRun start : f.seeds()) {
      const auto [x, y] = pixels_of({&start, 1}).front();
      ASSERT_EQ(f.is_open(start), used.count({x, y}) == 0);
      if (!f.is_open(start)) continue;
      const SlowRegion expected(f, used, x, y);
      const Region region = grow(f.field, start, kTau, f.storage);
      ASSERT_EQ(region.runs.size(), expected.runs().size());
      std::size_t size = 0;
      double beyond = 0;
      for (std::size_t i = 0; i < region.runs.size(); ++i) {
        const Pixels pixels = pixels_of(region.runs.subspan(i, 1));
        ASSERT_EQ(pixels, expected.runs()[i]);
        size += pixels.size();
        for (const auto& [px, py] : pixels) beyond += static_cast<Angle>(f.angle(px, py) - f.angle(x, y));
      }
      EXPECT_EQ(region.size, static_cast<std::int32_t>(size));
      EXPECT_LE(std::abs(std::remainder(f.angle(x, y) + beyond / static_cast<double>(size) - region.angle(),
                                        65536)),
                1);
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

// The angles of a noise-free edge have no spread, so tighten() uses the least tolerance.
TEST(Region, NoiseFreeEdgeStaysOneRegionAtTheLeastTolerance) {
  constexpr int kSide = 40;
  for (const bool upright : {true, false}) {
    std::vector<std::uint8_t> image;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) image.push_back((upright ? x : y) < kSide / 2 ? 40 : 200);
    Field f(kSide, kSide, image);
    ASSERT_EQ(f.field.seed_count, kSide - 1U);
    EXPECT_EQ(grow(f.field, f.field.seeds[0], kLeastTolerance, f.storage).size, kSide - 1);
  }
}

TEST(Region, PixelsAreReleasedAtMostKMaxReleasesTimes) {
  Field f = busy_field(4);
  const PixelRun seed = f.field.seeds[0];
  for (int i = 0; i < 20; ++i) {
    const Region region = grow(f.field, seed, kTau, f.storage);
    const Pixels pixels = pixels_of(region.runs);
    if (i <= kMaxReleases) {
      EXPECT_GT(region.size, 3);
    } else {
      EXPECT_EQ(region.size, 1);  // all its neighbours were released too often
    }
    for (const PixelRun run : region.runs) release(f.field, run);
    for (const auto& [x, y] : pixels) EXPECT_EQ(f.is_open(x, y), i < kMaxReleases);
    if (i == 0) {
      for (const auto& [x, y] : pixels)  // the magnitudes do not change
        EXPECT_NEAR(f.magnitude(x, y), busy_field(4).magnitude(x, y), 0);
    }
  }
}

TEST(Rectangle, HasTheMomentsOfItsRegionAndContainsIt) {
  Field f = busy_field(6);
  int compared = 0;
  for (const PixelRun start : f.seeds()) {
    if (!f.is_open(start)) continue;
    const Region region = grow(f.field, start, kTau, f.storage);
    const Rectangle r = fit_rectangle(region, weigh(f.field, region));
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double mass = 0;
    const Pixels pixels = pixels_of(region.runs);
    for (const auto& [x, y] : pixels) {
      const double w = f.magnitude(x, y);
      centre += w * Eigen::Vector2d(x, y);
      mass += w;
      EXPECT_TRUE(along(r, x, y) >= r.along_min && along(r, x, y) <= r.along_max);
      EXPECT_TRUE(across(r, x, y) >= r.across_min && across(r, x, y) <= r.across_max);
    }
    centre /= mass;
    EXPECT_NEAR(r.x_q8 / 256.0, centre.x(), 0.003);
    EXPECT_NEAR(r.y_q8 / 256.0, centre.y(), 0.003);
    EXPECT_GE(r.width_q8(), 256);
    EXPECT_GE(std::sin(radians(region.angle())) * r.dx - std::cos(radians(region.angle())) * r.dy, -1);
    if (region.size < 5) continue;
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    for (const auto& [x, y] : pixels) {
      const Eigen::Vector2d d = Eigen::Vector2d(x, y) - centre;
      moments += static_cast<double>(f.magnitude(x, y)) * d * d.transpose();
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
        const std::int32_t l = along(r, x, y);
        const std::int32_t t = across(r, x, y);
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

TEST(AngleRange, ContainsAnglesWithinItsTolerance) {
  Random random(3);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto middle = static_cast<Angle>(random.below(65536) - 32768);
    const auto tolerance = static_cast<Angle>(trial % 2 == 0 ? kTau : 3 + random.below(kTau));
    const AngleRange range(middle, tolerance);
    std::array<Angle, kBlockPixels> eight;
    for (Angle& angle : eight) {
      const int spread = trial % 3 == 0 ? 32768 : tolerance + 2;
      angle = static_cast<Angle>(middle + static_cast<int>(random.below(2 * static_cast<unsigned>(spread))) -
                                 spread);
    }
    const unsigned held = range.holding(eight.data());
    for (int i = 0; i < kBlockPixels; ++i) {
      const Angle angle = eight[static_cast<std::size_t>(i)];
      const bool within =
          angle_between(radians(angle), radians(middle)) <= (tolerance + 0.5) / kAnglePerRadian;
      EXPECT_EQ(range.holds(angle), within) << angle << " " << middle << " " << tolerance;
      EXPECT_EQ((held >> i & 1) != 0, within);
    }
  }
}

TEST(AngleSum, AddsTheChosenAngles) {
  Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto from = static_cast<Angle>(random.below(65536) - 32768);
    AngleSum sum(from);
    int beyond = 0;
    std::int64_t squares = 0, found_squares = 0;
    for (int block = 0; block < 5; ++block) {
      std::array<Angle, kBlockPixels> eight;
      const auto bits = static_cast<unsigned>(random.below(256));
      for (unsigned i = 0; i < kBlockPixels; ++i) {
        const int off = static_cast<int>(random.below(40000)) - 20000;
        eight[i] = static_cast<Angle>(from + off);
        if ((bits >> i & 1) == 0) continue;
        beyond += off;
        squares += std::int64_t{off} * off;
      }
      sum.add(eight.data(), bits);
      found_squares += squares_beyond(from, eight.data(), bits);
    }
    EXPECT_EQ(sum.beyond(), beyond);
    EXPECT_EQ(found_squares, squares);
  }
}

TEST(AngleSum, SquaresHalfTurns) {
  std::array<Angle, kBlockPixels> eight;
  eight.fill(INT16_MIN);
  EXPECT_EQ(squares_beyond(0, eight.data(), 0xffU), std::int64_t{8} << 30);
}

// Tightening subtracts the removed pixels from the sums of a region; the result must be the sums of the rest.
TEST(Validation, TightenedRegionHasTheSumsOfItsPixels) {
  Field f = busy_field(9);
  int cut = 0;
  for (const PixelRun start : f.seeds()) {
    if (!f.is_open(start)) continue;
    Region region = grow(f.field, start, kTau, f.storage);
    if (region.size < 10) continue;
    const std::int32_t grown = region.size;
    GradientMass mass = weigh(f.field, region);
    Rectangle rectangle = fit_rectangle(region, mass);
    if (!tighten(f.field, region, mass, rectangle, 10, f.storage) || region.size == grown) continue;
    ++cut;
    std::int32_t size = 0;
    std::int64_t beyond = 0, m = 0, mx = 0, my = 0, mxx = 0, mxy = 0, myy = 0;
    for (const auto& [px, py] : pixels_of(region.runs)) {
      ++size;
      beyond += static_cast<Angle>(f.angle(px, py) - region.from);
      const std::int64_t w = f.magnitude(px, py);
      const std::int64_t x = px - first_x(region.seed), y = py - region.seed.row;
      m += w;
      mx += w * x;
      my += w * y;
      mxx += w * x * x;
      mxy += w * x * y;
      myy += w * y * y;
    }
    EXPECT_EQ(region.size, size);
    EXPECT_EQ(region.beyond, beyond);
    EXPECT_TRUE(mass.m == m && mass.mx == mx && mass.my == my);
    EXPECT_TRUE(mass.mxx == mxx && mass.mxy == mxy && mass.myy == myy);
  }
  EXPECT_GT(cut, 10);
}

TEST(Validation, CountsThePixelsInTheRectangle) {
  Field f = busy_field(8);
  const FalseAlarms alarms(f.width, f.height);
  int meaningful = 0;
  for (const PixelRun start : f.seeds()) {
    if (!f.is_open(start)) continue;
    const Region region = grow(f.field, start, kTau, f.storage);
    Rectangle r = fit_rectangle(region, weigh(f.field, region));
    if (region.size < 10 || !is_dense(r, region.size)) continue;
    const double found = meaningfulness(f.field, alarms, r);
    const AngleRange range(
        static_cast<Angle>(round_to<std::int32_t>(std::atan2(r.dx, -r.dy) * kAnglePerRadian)), kTau);
    int n = 0, k = 0;
    for (int y = 0; y < f.field.height; ++y) {
      for (int x = 0; x < f.field.width; ++x) {
        const std::int32_t l = along(r, x, y);
        const std::int32_t t = across(r, x, y);
        if (l < r.along_min || l > r.along_max || t < r.across_min || t > r.across_max) continue;
        ++n;
        k += f.is_directed(x, y) && range.holds(f.angle(x, y)) ? 1 : 0;
      }
    }
    EXPECT_EQ(found, alarms.meaningfulness(n, k));
    meaningful += found >= 0 ? 1 : 0;
  }
  EXPECT_GE(meaningful, 5);
}

}  // namespace
}  // namespace plvo::lsd
