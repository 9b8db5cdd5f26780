// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/image_reduction.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "says.hpp"

namespace plvo {
namespace {

using test::says;

TEST(ImageReduction, ChoosesTheSmallestSufficientFactor) {
  EXPECT_EQ(least_reduction(640, 480), 1);
  EXPECT_EQ(least_reduction(2047, 2047), 1);
  EXPECT_EQ(least_reduction(2048, 1536), 2);
  EXPECT_EQ(least_reduction(3840, 2160), 2);
  EXPECT_EQ(least_reduction(3072, 4096), 3);
}

TEST(ImageReduction, RejectsUnsuitableFactors) {
  EXPECT_TRUE(check_reduction(1, 640, 480).ok());
  EXPECT_TRUE(check_reduction(7, 640, 480).ok());
  EXPECT_TRUE(says(check_reduction(8, 640, 480),
                   "images of 640x480 scaled down by 8 are 80x60, and plvo takes 64x64 to 2047x2047"));
  EXPECT_TRUE(says(check_reduction(1, 2048, 1536), "scaled down by 1 are 2048x1536"));
  EXPECT_TRUE(says(check_reduction(-2, 640, 480), "a whole number that is at least 1"));
  EXPECT_TRUE(check_reduction(1, 48, 32).ok()) << "what was not made smaller is not this one's to judge";
}

TEST(ImageReduction, ReducedCameraKeepsTheRays) {
  const CameraModel whole = {.width = 645,
                             .height = 483,
                             .pinhole = {525.5, 524, 319.25, 240.75},
                             .distortion = {.k1 = -0.1},
                             .readout_s = 0.0241};
  for (const int factor : {2, 3, 5}) {
    const CameraModel small = reduced(whole, factor);
    EXPECT_EQ(small.width, 645 / factor);
    EXPECT_EQ(small.height, 483 / factor);
    EXPECT_EQ(small.distortion.k1, whole.distortion.k1) << "a lens is of rays, not of pixels";
    const Vector3 p(0.3, -0.2, 1.7);
    const Vector2 in_whole = project(whole.pinhole, p), in_small = project(small.pinhole, p);
    // The middle of a small pixel is the middle of its block.
    const Vector2 expected = factor * in_small + Vector2::Constant(0.5 * (factor - 1));
    EXPECT_LT((expected - in_whole).norm(), 1e-12);
    // Consecutive small rows are `factor` rows apart.
    EXPECT_NEAR(small.readout_s / (small.height - 1), factor * whole.readout_s / (whole.height - 1), 1e-15);
  }
  const CameraModel same = reduced(whole, 1);
  EXPECT_EQ(same.pinhole.cx, whole.pinhole.cx);
  EXPECT_EQ(same.readout_s, whole.readout_s);
}

TEST(ImageReduction, AveragesEachBlock) {
  // 7×5 pixels; with a factor of 2 the last column and row are left over.
  constexpr int kWidth = 7, kHeight = 5;
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<std::uint8_t>((37 * x + 91 * y + 53 * c) % 256));
  for (const int factor : {2, 3}) {
    const int width = kWidth / factor, height = kHeight / factor;
    std::vector<std::uint8_t> out(static_cast<std::size_t>(3 * width * height) + 1, 7);
    reduce_rgb(rgb.data(), kWidth, factor, width, height, out.data());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) {
          double sum = 0;
          for (int j = 0; j < factor; ++j)
            for (int i = 0; i < factor; ++i)
              sum += rgb[static_cast<std::size_t>(3 * ((y * factor + j) * kWidth + x * factor + i) + c)];
          EXPECT_NEAR(out[static_cast<std::size_t>(3 * (y * width + x) + c)], sum / (factor * factor), 0.5);
        }
    EXPECT_EQ(out.back(), 7) << "nothing beyond";
  }
}

}  // namespace
}  // namespace plvo
