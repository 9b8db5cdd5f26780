// SPDX-License-Identifier: Apache-2.0
// Compares both filters with sums in double precision, rounded half up, with repeated borders. The sums are
// exact because every product is an integer below 2^20. The reference of the halving filter sums over the
// whole two-dimensional kernel; that of the other filter sums down and then across, as it is defined.
#include "plvo/image/smoothing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gray_image.hpp"

namespace plvo {
namespace {

using test::GrayImage;

// The weighted mean around (x, y) over the two-dimensional kernel.
std::uint8_t filtered(GrayView image, int x, int y, const std::vector<int>& weights, double sum_of_weights) {
  const int radius = static_cast<int>(weights.size() / 2);
  double sum = 0;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx)
      sum += weights[static_cast<std::size_t>(dy + radius)] * weights[static_cast<std::size_t>(dx + radius)] *
             image.at(std::clamp(x + dx, 0, image.width - 1), std::clamp(y + dy, 0, image.height - 1));
  return static_cast<std::uint8_t>(std::floor(sum / (sum_of_weights * sum_of_weights) + 0.5));
}

// The weighted mean down, rounded to quarters, and then across.
std::uint8_t filtered_in_turn(GrayView image, int x, int y, const std::vector<int>& weights,
                              double sum_of_weights) {
  const int radius = static_cast<int>(weights.size() / 2);
  double sum = 0;
  for (int dx = -radius; dx <= radius; ++dx) {
    double column = 0;
    for (int dy = -radius; dy <= radius; ++dy)
      column += weights[static_cast<std::size_t>(dy + radius)] *
                image.at(std::clamp(x + dx, 0, image.width - 1), std::clamp(y + dy, 0, image.height - 1));
    sum += weights[static_cast<std::size_t>(dx + radius)] * std::floor(4 * column / sum_of_weights + 0.5);
  }
  return static_cast<std::uint8_t>(std::floor(sum / (4 * sum_of_weights) + 0.5));
}

const std::vector<int> kBinomial7{1, 6, 15, 20, 15, 6, 1};
const std::vector<int> kBinomial5{1, 4, 6, 4, 1};

struct Size {
  int width, height;
};
const Size kSizes[] = {{1, 1}, {2, 1}, {1, 5}, {3, 2}, {5, 7}, {8, 8}, {33, 17}, {64, 48}, {101, 77}};

constexpr std::uint8_t kUntouched = 0xa5;
constexpr int kPadding = 5;

void expect_padding_untouched(const GrayImage& image) {
  const auto stride = static_cast<std::size_t>(image.width() + kPadding);
  for (std::size_t i = 0; i < image.pixels().size(); ++i)
    if (i % stride >= static_cast<std::size_t>(image.width())) {
      ASSERT_EQ(image.pixels()[i], kUntouched) << i;
    }
}

TEST(Smoothing, Binomial7SumsDownAndThenAcross) {
  Random random(7);
  for (const Size& size : kSizes) {
    SCOPED_TRACE(testing::Message() << size.width << "x" << size.height);
    const GrayImage in = test::random_image(size.width, size.height, random, 3);
    GrayImage out(size.width, size.height, kPadding, kUntouched);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(size.width) + 16);
    smooth_binomial7(in.view(), out.view(), row);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        ASSERT_EQ(out.view().at(x, y), filtered_in_turn(in.view(), x, y, kBinomial7, 64)) << x << " " << y;
    expect_padding_untouched(out);
  }
}

TEST(Smoothing, HalvingEqualsTheTwoDimensionalSumAtEverySecondPixel) {
  Random random(5);
  for (const Size& size : kSizes) {
    SCOPED_TRACE(testing::Message() << size.width << "x" << size.height);
    const GrayImage in = test::random_image(size.width, size.height, random, 3);
    GrayImage out((size.width + 1) / 2, (size.height + 1) / 2, kPadding, kUntouched);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(size.width) + 16);
    halve_binomial5(in.view(), out.view(), row);
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x)
        ASSERT_EQ(out.view().at(x, y), filtered(in.view(), 2 * x, 2 * y, kBinomial5, 16)) << x << " " << y;
    expect_padding_untouched(out);
  }
}

TEST(Smoothing, ConstantImagesDoNotOverflow) {
  for (std::uint8_t level : {std::uint8_t{0}, std::uint8_t{127}, std::uint8_t{255}}) {
    const GrayImage in(40, 30, 0, level);
    GrayImage out(40, 30);
    GrayImage half(20, 15);
    std::vector<std::uint16_t> row(56);
    smooth_binomial7(in.view(), out.view(), row);
    halve_binomial5(in.view(), half.view(), row);
    EXPECT_EQ(out.pixels(), in.pixels());
    EXPECT_EQ(half.pixels(), GrayImage(20, 15, 0, level).pixels());
  }
}

}  // namespace
}  // namespace plvo
