// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/gray.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "gray_image.hpp"

namespace plvo {
namespace {

using test::GrayImage;

constexpr int kColourWidth = 37;
constexpr int kColourHeight = 11;

// Rows are padded beyond three bytes per pixel, as some cameras deliver them.
struct Colour {
  explicit Colour(PixelFormat format) : bytes(kStride * kColourHeight) {
    Random random(601);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    view = {bytes.data(), kColourWidth, kColourHeight, kStride, format};
  }
  int byte(int x, int y, int channel) const {
    return bytes[static_cast<std::size_t>(y * kStride + 3 * x + channel)];
  }
  static constexpr int kStride = 3 * kColourWidth + 7;
  std::vector<std::uint8_t> bytes;
  ColourView view;
};

TEST(Gray, FollowsTheFormulaForRgbAndBgr) {
  for (PixelFormat format : {PixelFormat::kRgb8, PixelFormat::kBgr8}) {
    const Colour colour(format);
    GrayImage gray(kColourWidth, kColourHeight, 3);
    to_gray(colour.view, gray.view());
    const int red = format == PixelFormat::kRgb8 ? 0 : 2;
    for (int y = 0; y < kColourHeight; ++y)
      for (int x = 0; x < kColourWidth; ++x) {
        const int r = colour.byte(x, y, red);
        const int g = colour.byte(x, y, 1);
        const int b = colour.byte(x, y, 2 - red);
        const double exact = (77.0 * r + 150.0 * g + 29.0 * b) / 256;
        ASSERT_EQ(gray.view().at(x, y), GrayImage::to_byte(exact)) << x << " " << y;
        // The formula equals BT.601 within one grey level.
        ASSERT_NEAR(gray.view().at(x, y), 0.299 * r + 0.587 * g + 0.114 * b, 1.0);
      }
  }
}

TEST(Gray, CopiesGreyAndKeepsTheLevelOfColourlessPixels) {
  const Colour one(PixelFormat::kGray8);
  GrayImage gray(kColourWidth, kColourHeight, 2);
  to_gray(one.view, gray.view());
  for (int y = 0; y < kColourHeight; ++y)
    for (int x = 0; x < kColourWidth; ++x)
      ASSERT_EQ(gray.view().at(x, y), one.bytes[static_cast<std::size_t>(y * Colour::kStride + x)]);

  for (int level = 0; level < 256; ++level) {
    const std::vector<std::uint8_t> pixel(3, static_cast<std::uint8_t>(level));
    GrayImage out(1, 1);
    to_gray({pixel.data(), 1, 1, 3, PixelFormat::kRgb8}, out.view());
    EXPECT_EQ(out.view().at(0, 0), level);
  }
}

TEST(Gray, BrightnessIsTheMeanOfEveryFourthRowAndColumn) {
  Random random(4);
  const GrayImage image = test::random_image(41, 30, random, 3);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < 30; y += 4)
    for (int x = 0; x < 41; x += 4, ++count) sum += image.view().at(x, y);
  EXPECT_DOUBLE_EQ(mean_brightness(image.view()), sum / count);
  EXPECT_EQ(mean_brightness(GrayView{}), 0);
}

}  // namespace
}  // namespace plvo
