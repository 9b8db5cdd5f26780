// SPDX-License-Identifier: Apache-2.0
// Tests the input of the bench's peers: without distortion the images do not change; with distortion, an
// image that is linear in the raw pixel coordinates is sampled at the coordinates of distort_pixel.
#include "plvo/bench/systems/ideal_images.hpp"

#include <gtest/gtest.h>

namespace plvo::bench {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

struct Pictures {
  std::vector<std::uint8_t> colour;
  std::vector<std::uint16_t> depth;
  RgbdFrame frame;
};

// Red grows with x, green with y, blue is 7; the depth encodes its pixel.
Pictures ramps(PixelFormat format) {
  Pictures p;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto red = static_cast<std::uint8_t>(3 * x);
      const auto green = static_cast<std::uint8_t>(5 * y);
      if (format == PixelFormat::kGray8) {
        p.colour.push_back(red);
      } else if (format == PixelFormat::kRgb8) {
        p.colour.insert(p.colour.end(), {red, green, 7});
      } else {
        p.colour.insert(p.colour.end(), {7, green, red});
      }
      p.depth.push_back(static_cast<std::uint16_t>(100 * y + x + 1));
    }
  }
  const int bytes = format == PixelFormat::kGray8 ? 1 : 3;
  p.frame.colour = {p.colour.data(), kWidth, kHeight, bytes * kWidth, format};
  p.frame.depth = {p.depth.data(), kWidth, kHeight, kWidth, 0.001};
  return p;
}

CameraModel small_camera() {
  CameraModel camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.pinhole = {52.5, 52.5, 31.5, 23.5};
  return camera;
}

TEST(IdealImages, WithoutDistortionNothingChanges) {
  for (const PixelFormat format : {PixelFormat::kGray8, PixelFormat::kRgb8, PixelFormat::kBgr8}) {
    const Pictures p = ramps(format);
    IdealImages images(small_camera());
    images.make(p.frame);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const bool gray = format == PixelFormat::kGray8;
      const int x = i % kWidth;
      const int y = i / kWidth;
      ASSERT_EQ(images.rgb()[3 * i], 3 * x);
      ASSERT_EQ(images.rgb()[3 * i + 1], gray ? 3 * x : 5 * y);
      ASSERT_EQ(images.rgb()[3 * i + 2], gray ? 3 * x : 7);
      ASSERT_EQ(images.depth()[i], p.depth[static_cast<std::size_t>(i)]);
    }
  }
}

TEST(IdealImages, SampleAtTheDistortedPixel) {
  CameraModel camera = small_camera();
  camera.distortion = {0.26, -0.95, -0.005, 0.003, 1.16};
  const Pictures p = ramps(PixelFormat::kRgb8);
  IdealImages images(camera);
  images.make(p.frame);
  int seen = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int i = y * kWidth + x;
      const Vector2 raw = distort_pixel(camera, Vector2(x, y));
      if (raw.x() < 0 || raw.y() < 0 || raw.x() > kWidth - 1 || raw.y() > kHeight - 1) {
        ASSERT_EQ(images.depth()[i], 0);
        ASSERT_EQ(images.rgb()[3 * i + 2], 0);
        continue;
      }
      ++seen;
      ASSERT_NEAR(images.rgb()[3 * i], 3 * raw.x(), 0.51);
      ASSERT_NEAR(images.rgb()[3 * i + 1], 5 * raw.y(), 0.51);
      ASSERT_EQ(images.rgb()[3 * i + 2], 7);
      const int nearest_x = static_cast<int>(raw.x() + 0.5);
      const int nearest_y = static_cast<int>(raw.y() + 0.5);
      ASSERT_EQ(images.depth()[i], 100 * nearest_y + nearest_x + 1);
    }
  }
  EXPECT_GT(seen, kWidth * kHeight / 2);
  EXPECT_LT(seen, kWidth * kHeight);
}

}  // namespace
}  // namespace plvo::bench
