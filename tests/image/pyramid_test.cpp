// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/pyramid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gray_image.hpp"

namespace plvo {
namespace {

// A pyramid and its memory.
class Owned {
 public:
  Owned(int width, int height) : memory_(bytes(width, height)), arena_(memory_) {
    pyramid.allocate(arena_, width, height);
    pyramid.init(width, height);
  }
  bool fits() const { return !arena_.exhausted(); }
  Pyramid pyramid;

  static constexpr std::size_t bytes(int width, int height) {
    Arena sizer = Arena::counting();
    Pyramid counted;
    counted.allocate(sizer, width, height);
    return sizer.peak() + kArenaAlignment;
  }

 private:
  std::vector<std::byte> memory_;
  Arena arena_;
};

struct Centroid {
  double x, y;
};
Centroid centroid(GrayView image) {
  double sum = 0, x_sum = 0, y_sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      sum += image.at(x, y);
      x_sum += image.at(x, y) * x;
      y_sum += image.at(x, y) * y;
    }
  return {x_sum / sum, y_sum / sum};
}

TEST(Pyramid, EveryLevelIsTheHalvedPreviousLevel) {
  Owned owned(101, 75);
  ASSERT_TRUE(owned.fits());
  Random random(3);
  for (int y = 0; y < 75; ++y)
    for (int x = 0; x < 101; ++x)
      owned.pyramid.base().at(x, y) = static_cast<std::uint8_t>(random.below(256));
  owned.pyramid.build();
  int width = 101;
  int height = 75;
  std::vector<std::uint16_t> row(101 + 16);
  for (int level = 1; level < Pyramid::kMaxLevels; ++level) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    const GrayView got = owned.pyramid.level(level);
    ASSERT_EQ(got.width, width);
    ASSERT_EQ(got.height, height);
    test::GrayImage expected(width, height);
    halve_binomial5(owned.pyramid.level(level - 1), expected.view(), row);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ASSERT_EQ(got.at(x, y), expected.view().at(x, y));
  }
}

TEST(Pyramid, PositionsScaleWithoutAnOffset) {
  // Pixel (x, y) of level l is (x, y) · 2^l of level 0, so a blob has the same position on every level.
  for (const Centroid& at : {Centroid{80, 64}, Centroid{81.3, 63.6}, Centroid{77, 59}}) {
    Owned owned(161, 129);
    for (int y = 0; y < 129; ++y)
      for (int x = 0; x < 161; ++x) {
        const double dx = x - at.x;
        const double dy = y - at.y;
        owned.pyramid.base().at(x, y) =
            test::GrayImage::to_byte(240 * std::exp(-(dx * dx + dy * dy) / (2 * 9.0 * 9.0)));
      }
    owned.pyramid.build();
    for (int level = 0; level < Pyramid::kMaxLevels; ++level) {
      const Centroid found = centroid(owned.pyramid.level(level));
      EXPECT_NEAR(found.x * (1 << level), at.x, 0.05) << "level " << level;
      EXPECT_NEAR(found.y * (1 << level), at.y, 0.05) << "level " << level;
    }
  }
}

TEST(Pyramid, TakesOneThirdMoreMemoryThanTheImage) {
  constexpr std::size_t kPixels = 640 * 480;
  static_assert(Owned::bytes(640, 480) < kPixels * 4 / 3 + 4096);
  static_assert(Owned::bytes(640, 480) > kPixels * 85 / 64);
}

}  // namespace
}  // namespace plvo
