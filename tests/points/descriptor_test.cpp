// SPDX-License-Identifier: Apache-2.0
// Compares the distance with a count bit by bit, tests the invariance to light, and measures the rate of
// right matches over roll and scale, which docs/decisions/descriptor_roll.md quotes.
#include "plvo/points/descriptor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "gray_image.hpp"
#include "plvo/image/smoothing.hpp"
#include "texture.hpp"

namespace plvo {
namespace {

using test::GrayImage;

Descriptor random_descriptor(Random& random) {
  Descriptor descriptor{};
  for (std::uint64_t& word : descriptor)
    word = static_cast<std::uint64_t>(random.next()) << 32 | random.next();
  return descriptor;
}

TEST(Descriptor, DistanceIsTheNumberOfDifferingBits) {
  Random random(256);
  for (int trial = 0; trial < 2000; ++trial) {
    const Descriptor a = random_descriptor(random);
    Descriptor b = random_descriptor(random);
    if (trial % 2 == 0) {
      b = a;
      for (std::uint32_t k = random.below(12); k > 0; --k)
        b[random.below(4)] ^= std::uint64_t{1} << random.below(64);
    }
    int count = 0;
    for (std::size_t i = 0; i < 256; ++i) count += ((a[i / 64] ^ b[i / 64]) >> (i % 64) & 1U) != 0 ? 1 : 0;
    ASSERT_EQ(hamming_distance(a, b), count);
  }
  const Descriptor none{};
  const Descriptor all{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}};
  EXPECT_EQ(hamming_distance(none, all), 256);
  EXPECT_EQ(hamming_distance(all, all), 0);
}

TEST(Descriptor, IsInvariantToStrictlyIncreasingMapsOfTheGreyLevels) {
  Random random(77);
  // The maps below keep the levels 60 … 187 distinct.
  GrayImage image(64, 50, 3);
  image.paint([&](int, int) { return 60 + random.below(64) * 2; });
  GrayImage brighter(64, 50), bent(64, 50);
  brighter.paint([&](int x, int y) { return image.view().at(x, y) * 0.6 + 30; });
  bent.paint([&](int x, int y) { return image.view().at(x, y) * image.view().at(x, y) / 140.0; });
  for (int y = kDescriptorRadius; y < 50 - kDescriptorRadius; ++y)
    for (int x = kDescriptorRadius; x < 64 - kDescriptorRadius; ++x) {
      const Descriptor expected = Describer(image.view())(x, y);
      ASSERT_EQ(Describer(brighter.view())(x, y), expected);
      ASSERT_EQ(Describer(bent.view())(x, y), expected);
    }
}

TEST(Descriptor, ReadsOnlyPixelsWithinItsRadius) {
  Random random(31);
  GrayImage image = test::random_image(41, 41, random);
  const Descriptor before = Describer(image.view())(20, 20);
  const Patch patch = cut_patch(image.view(), 20, 20);
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x)
      if (std::abs(x - 20) > kDescriptorRadius || std::abs(y - 20) > kDescriptorRadius)
        image.view().at(x, y) = static_cast<std::uint8_t>(255 - image.view().at(x, y));
  EXPECT_EQ(Describer(image.view())(20, 20), before);
  EXPECT_EQ(cut_patch(image.view(), 20, 20), patch);
}

TEST(Descriptor, PatchHoldsThePixelsRowByRow) {
  Random random(11);
  const GrayImage image = test::random_image(30, 25, random, 4);
  const Patch patch = cut_patch(image.view(), 12, 9);
  std::size_t i = 0;
  for (int y = 9 - kPatchRadius; y <= 9 + kPatchRadius; ++y)
    for (int x = 12 - kPatchRadius; x <= 12 + kPatchRadius; ++x) EXPECT_EQ(patch[i++], image.view().at(x, y));
  EXPECT_EQ(i, patch.size());
}

TEST(Descriptor, OfRandomImagesHasHalfOfItsBitsSetAndDiffersInHalf) {
  Random random(5);
  const GrayImage image = test::random_image(400, 60, random);
  double set = 0, differ = 0;
  constexpr int kPlaces = 20;
  for (int i = 0; i < kPlaces; ++i) {
    const Descriptor a = Describer(image.view())(20 + 15 * i, 20);
    const Descriptor b = Describer(image.view())(25 + 15 * i, 38);
    set += hamming_distance(a, {}) / 256.0 / kPlaces;
    differ += hamming_distance(a, b) / 256.0 / kPlaces;
  }
  EXPECT_NEAR(set, 0.5, 0.04);
  EXPECT_NEAR(differ, 0.5, 0.04);
}

// The texture rotated by `roll_rad` about the middle and enlarged by `scale`, with noise (SD 2), smoothed.
constexpr int kTurnedSide = 360;
GrayImage turned_texture(double roll_rad, double scale, std::uint64_t noise_seed) {
  const test::Texture texture(21);
  Random random(noise_seed);
  GrayImage image(kTurnedSide, kTurnedSide), smoothed(kTurnedSide, kTurnedSide);
  const double c = std::cos(roll_rad) / scale;
  const double s = std::sin(roll_rad) / scale;
  image.paint([&](int x, int y) {
    const double dx = x - kTurnedSide / 2, dy = y - kTurnedSide / 2;
    return texture(c * dx + s * dy, -s * dx + c * dy) + test::gaussian(random) * 2;
  });
  std::vector<std::uint16_t> row(kTurnedSide + 16);
  smooth_binomial7(image.view(), smoothed.view(), row);
  return smoothed;
}

// Rate of right matches when the image is rotated by `roll_rad` and enlarged by `scale`. A place of the
// texture is matched when its own descriptor is the nearest among those of all places, within 64 bits, and
// clearly nearer than any other. Both images have independent noise. The position is wrong by up to half a
// pixel, like that of a detector.
double match_rate(const GrayImage& reference, double roll_rad, double scale) {
  const GrayImage turned = turned_texture(roll_rad, scale, 4712);
  std::vector<Descriptor> before, after;
  // These places stay inside the image at every roll and scale of the table.
  for (int y = -90; y <= 90; y += 15)
    for (int x = -100; x <= 100; x += 15) {
      const double u = scale * (std::cos(roll_rad) * x - std::sin(roll_rad) * y) + kTurnedSide / 2;
      const double v = scale * (std::sin(roll_rad) * x + std::cos(roll_rad) * y) + kTurnedSide / 2;
      before.push_back(Describer(reference.view())(x + kTurnedSide / 2, y + kTurnedSide / 2));
      after.push_back(Describer(turned.view())(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5)));
    }
  int right = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int own = hamming_distance(before[i], after[i]);
    bool matched = own <= 64;
    for (std::size_t j = 0; j < after.size() && matched; ++j)
      matched = j == i || own <= 0.85 * hamming_distance(before[i], after[j]);
    right += matched ? 1 : 0;
  }
  return right / static_cast<double>(before.size());
}

TEST(Descriptor, MatchesOverRollAndScale) {
  constexpr double kScales[] = {0.8, 0.9, 1.0, 1.1, 1.25};
  std::printf("rate of right matches | roll \\ scale");
  for (double scale : kScales) std::printf(" | %.2f", scale);
  std::printf("\n");
  const GrayImage reference = turned_texture(0, 1, 4711);
  double rate[7][5] = {};
  for (std::size_t r = 0; r < 7; ++r) {
    std::printf("%2d deg", static_cast<int>(r) * 5);
    for (std::size_t s = 0; s < 5; ++s) {
      rate[r][s] = match_rate(reference, static_cast<double>(r) * 5 * 3.14159265358979 / 180, kScales[s]);
      std::printf(" | %.2f", rate[r][s]);
    }
    std::printf("\n");
  }
  EXPECT_GT(rate[0][2], 0.98);
  EXPECT_GT(rate[2][2], 0.90) << "10 degrees between two frames is a fast roll: 300 degrees a second";
  EXPECT_GT(rate[0][1], 0.95);
  EXPECT_GT(rate[0][3], 0.95);
  // The descriptor is not invariant to rotation, so the rate falls with roll.
  EXPECT_LT(rate[6][2], rate[0][2]);
}

}  // namespace
}  // namespace plvo
