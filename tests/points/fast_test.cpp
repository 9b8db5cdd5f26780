// SPDX-License-Identifier: Apache-2.0
// Compares the segment test with its definition, threshold by threshold.
#include "plvo/points/fast.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "gray_image.hpp"

namespace plvo {
namespace {

using test::GrayImage;

// The circle of radius 3, clockwise from the top.
constexpr int kCircle[16][2] = {{0, -3}, {1, -3}, {2, -2}, {3, -1}, {3, 0},  {3, 1},   {2, 2},   {1, 3},
                                {0, 3},  {-1, 3}, {-2, 2}, {-3, 1}, {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}};

// Whether nine contiguous pixels of the circle are all brighter, or all darker, by more than the threshold.
bool passes(GrayView image, int x, int y, int threshold) {
  for (int sign : {1, -1})
    for (int start = 0; start < 16; ++start) {
      int run = 0;
      while (run < 9) {
        const int* offset = kCircle[(start + run) % 16];
        if (!(sign * (image.at(x + offset[0], y + offset[1]) - image.at(x, y)) > threshold)) break;
        ++run;
      }
      if (run == 9) return true;
    }
  return false;
}

// The smallest threshold that the pixel does not pass; it passes all smaller ones.
int reference_score(GrayView image, int x, int y) {
  int threshold = 0;
  while (passes(image, x, y, threshold)) ++threshold;
  return threshold;
}

void expect_same(const GrayImage& owner) {
  const GrayView image = owner.view();
  const int width = image.width - 6;
  std::vector<std::uint8_t> scores(static_cast<std::size_t>(width));
  for (int y = 3; y < image.height - 3; ++y) {
    for (const int floor : {0, 5, 60}) {
      segment_test_row(image.row(y) + 3, image.stride, width, static_cast<std::uint8_t>(floor),
                       scores.data());
      for (int x = 3; x < image.width - 3; ++x) {
        const int score = scores[static_cast<std::size_t>(x - 3)];
        const int expected = reference_score(image, x, y);
        ASSERT_TRUE(expected > floor ? score == expected : score <= floor)
            << x << " " << y << ": " << score << " for " << expected << ", floor " << floor;
      }
    }
  }
}

TEST(SegmentTest, AgreesWithTheDefinitionOnRandomImages) {
  Random random(9);
  // The widths do and do not fill SIMD vectors.
  for (int width : {7, 22, 23, 38, 71, 101}) expect_same(test::random_image(width, 13, random, 5));
}

TEST(SegmentTest, AgreesWithTheDefinitionOnCornersEdgesAndSpots) {
  Random random(16);
  for (int trial = 0; trial < 40; ++trial) {
    GrayImage image(40, 30);
    const std::uint8_t ground = static_cast<std::uint8_t>(random.below(256));
    image.paint([&](int, int) { return ground; });
    for (int box = 0; box < 12; ++box) {
      const int x0 = static_cast<int>(random.below(40));
      const int y0 = static_cast<int>(random.below(30));
      const int w = 1 + static_cast<int>(random.below(14));
      const int h = 1 + static_cast<int>(random.below(14));
      const auto level = static_cast<std::uint8_t>(random.below(256));
      for (int y = y0; y < std::min(30, y0 + h); ++y)
        for (int x = x0; x < std::min(40, x0 + w); ++x) image.view().at(x, y) = level;
    }
    expect_same(image);
  }
}

TEST(SegmentTest, AgreesWithTheDefinitionForEveryPatternOfTheCircle) {
  // The test covers all 2^16 patterns of brighter and not brighter, so the nine pixels start at every
  // position.
  GrayImage image(7, 7, 0, 100);
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    const auto brighter = static_cast<std::uint8_t>(150 + bits % 100);
    for (std::uint32_t i = 0; i < 16; ++i)
      image.view().at(3 + kCircle[i][0], 3 + kCircle[i][1]) =
          (bits >> i & 1U) != 0 ? brighter : std::uint8_t{100};
    const std::uint32_t twice = bits | bits << 16;
    bool run = false;
    for (std::uint32_t start = 0; start < 16; ++start) run = run || ((twice >> start) & 0x1ffU) == 0x1ffU;
    std::uint8_t score = 0;
    segment_test_row(image.view().row(3) + 3, 7, 1, 0, &score);
    ASSERT_EQ(score, run ? brighter - 100 : 0) << bits;
  }
}

TEST(SegmentTest, ScoreReachesTheEndsOfItsRange) {
  GrayImage black(7, 7, 0, 0);
  black.view().at(3, 3) = 255;
  std::uint8_t score = 0;
  segment_test_row(black.view().row(3) + 3, 7, 1, 0, &score);
  EXPECT_EQ(score, 255);
  GrayImage white(7, 7, 0, 255);
  segment_test_row(white.view().row(3) + 3, 7, 1, 0, &score);
  EXPECT_EQ(score, 0) << "nothing is brighter or darker";
  white.view().at(3, 3) = 0;
  segment_test_row(white.view().row(3) + 3, 7, 1, 0, &score);
  EXPECT_EQ(score, 255);
}

}  // namespace
}  // namespace plvo
