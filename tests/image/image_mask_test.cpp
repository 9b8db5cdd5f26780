// SPDX-License-Identifier: Apache-2.0
// The mask of the camera's image, compared with a search of every pixel around.
#include "plvo/image/image_mask.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "plvo/base/arena.hpp"
#include "plvo/image/gray.hpp"

namespace plvo {
namespace {

constexpr int kMaskWidth = 93;
constexpr int kMaskHeight = 70;
constexpr int kMostExcess_px = 6;  // by which is_free() keeps too far from masked pixels

CameraModel masked_camera(const Distortion& distortion) {
  CameraModel camera;
  camera.width = kMaskWidth;
  camera.height = kMaskHeight;
  camera.pinhole = {80, 80, 46, 35};
  camera.distortion = distortion;
  return camera;
}

// A bar at the bottom, a small square and a single pixel.
std::vector<std::uint8_t> some_pixels_used() {
  std::vector<std::uint8_t> used(kMaskWidth * kMaskHeight, 255);
  for (int y = 0; y < kMaskHeight; ++y)
    for (int x = 0; x < kMaskWidth; ++x)
      if (y >= 62 || (x >= 20 && x < 27 && y >= 11 && y < 17) || (x == 70 && y == 30))
        used[static_cast<std::size_t>(y * kMaskWidth + x)] = 0;
  return used;
}

struct MaskRig {
  explicit MaskRig(const Distortion& distortion, std::vector<std::uint8_t> pixels = some_pixels_used())
      : used(std::move(pixels)), memory(200'000) {
    Arena arena(memory);
    map.allocate(arena, kMaskWidth, kMaskHeight);
    map.init(masked_camera(distortion));
    mask.allocate(arena, kMaskWidth, kMaskHeight);
    mask.init({used.data(), kMaskWidth, kMaskHeight, kMaskWidth}, map);
  }
  bool is_used(int x, int y) const { return used[static_cast<std::size_t>(y * kMaskWidth + x)] != 0; }

  std::vector<std::uint8_t> used;
  std::vector<std::byte> memory;
  UndistortionMap map;
  ImageMask mask;
};

// The undistorted pixels that change with the content of a masked one.
std::vector<std::uint8_t> depends_on_masked(const MaskRig& rig) {
  const auto shown = [&](std::uint8_t level) {
    std::vector<std::uint8_t> raw(rig.used.size());
    for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = rig.used[i] == 0 ? level : 0;
    if (!rig.map.active()) return raw;
    std::vector<std::uint8_t> ideal(raw.size());
    rig.map.undistort({raw.data(), kMaskWidth, kMaskHeight, kMaskWidth},
                      {ideal.data(), kMaskWidth, kMaskHeight, kMaskWidth});
    return ideal;
  };
  return shown(255);
}

class LensesOfMasks : public testing::TestWithParam<Distortion> {};

TEST_P(LensesOfMasks, IsFreeExactlyAwayFromMaskedPixels) {
  const MaskRig rig(GetParam());
  ASSERT_TRUE(rig.mask.active());
  const std::vector<std::uint8_t> masked = depends_on_masked(rig);
  const auto any_within = [&](int x, int y, int reach) {
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, kMaskHeight - 1); ++j)
      for (int i = std::max(x - reach, 0); i <= std::min(x + reach, kMaskWidth - 1); ++i) {
        int raw_x = 0, raw_y = 0;
        if (masked[static_cast<std::size_t>(j * kMaskWidth + i)] != 0 &&
            rig.map.raw_pixel(i, j, raw_x, raw_y))
          return true;
      }
    return false;
  };
  for (const int reach : {0, 1, 5, 8, 14})
    for (int y = 0; y < kMaskHeight; ++y)
      for (int x = 0; x < kMaskWidth; ++x) {
        if (rig.mask.is_free(x, y, reach))
          EXPECT_FALSE(any_within(x, y, reach)) << x << ' ' << y << ' ' << reach;
        else
          EXPECT_TRUE(any_within(x, y, reach + kMostExcess_px + (rig.map.active() ? 2 : 0)))
              << x << ' ' << y << ' ' << reach;
      }
}

INSTANTIATE_TEST_SUITE_P(Lenses, LensesOfMasks,
                         testing::Values(Distortion{}, Distortion{-0.25, 0.06, 0, 0, 0},
                                         Distortion{0.12, 0.02, 0.002, -0.001, 0}));

TEST(ImageMask, MakesMaskedPixelsGreyAndLeavesTheOthers) {
  const MaskRig rig({});
  std::vector<std::uint8_t> gray(rig.used.size(), 7);
  constexpr int kFirst = 10;  // rows are blanked in parts
  rig.mask.blank({gray.data(), kMaskWidth, kFirst, kMaskWidth}, 0);
  rig.mask.blank({gray.data() + kFirst * kMaskWidth, kMaskWidth, kMaskHeight - kFirst, kMaskWidth}, kFirst);
  for (std::size_t i = 0; i < gray.size(); ++i) EXPECT_EQ(gray[i], rig.used[i] == 0 ? 128 : 7);
}

TEST(ImageMask, LeavesOutTheDepthOfMaskedPixels) {
  const MaskRig rig({});
  constexpr int kStride = kMaskWidth + 5;
  std::vector<std::uint16_t> depth(kStride * kMaskHeight);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(i + 1);
  const DepthView copy = rig.mask.without_masked({depth.data(), kMaskWidth, kMaskHeight, kStride, 0.0002});
  EXPECT_EQ(copy.metres_per_unit, 0.0002);
  for (int y = 0; y < kMaskHeight; ++y)
    for (int x = 0; x < kMaskWidth; ++x)
      EXPECT_EQ(copy.data[y * copy.stride + x],
                rig.is_used(x, y) ? depth[static_cast<std::size_t>(y * kStride + x)] : 0);
}

TEST(ImageMask, IsNotPartOfTheMeanBrightness) {
  const MaskRig rig({});
  std::vector<std::uint8_t> gray(rig.used.size(), 40);
  for (std::size_t i = 0; i < gray.size(); ++i)
    if (rig.used[i] == 0) gray[i] = 250;
  const GrayView view{gray.data(), kMaskWidth, kMaskHeight, kMaskWidth};
  EXPECT_EQ(mean_brightness(view, rig.mask), 40);
  EXPECT_GT(mean_brightness(view), 40);
}

TEST(ImageMask, AllPixelsAreFreeWithoutAMaskAndWithAWhiteOne) {
  EXPECT_FALSE(ImageMask().active());
  EXPECT_TRUE(ImageMask().is_free(3, 4, 1000));
  const MaskRig white({}, std::vector<std::uint8_t>(kMaskWidth * kMaskHeight, 1));
  for (int y = 0; y < kMaskHeight; ++y)
    for (int x = 0; x < kMaskWidth; ++x) EXPECT_TRUE(white.mask.is_free(x, y, 100));
}

TEST(ImageMask, ReachGrowsWithTheLevelAndItsSmoothing) {
  EXPECT_EQ(reach_on_base(0, 5), 5);
  EXPECT_EQ(reach_on_base(1, 5), 12);
  EXPECT_EQ(reach_on_base(2, 5), 26);
}

}  // namespace
}  // namespace plvo
