// SPDX-License-Identifier: Apache-2.0
// Registers patches of a smooth texture that is rendered again at known sub-pixel shifts under another light.
#include "plvo/points/alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "gray_image.hpp"
#include "plvo/points/descriptor.hpp"
#include "plvo/points/detector.hpp"
#include "texture.hpp"
#include "whole_window.hpp"

namespace plvo {
namespace {

using test::GrayImage;
using test::kWholeWindow;

constexpr int kImageSide = 60;
constexpr int kImageCentre = 30;
// Smooth enough that bilinear interpolation between the pixels is nearly exact.
constexpr double kGrain = 1.2;

// The texture shifted by (dx, dy), with this gain, offset and SD of the noise.
GrayImage render(const test::Texture& texture, double dx, double dy, double gain, double offset, double noise,
                 Random& random) {
  GrayImage image(kImageSide, kImageSide, 5);
  image.paint([&](int x, int y) {
    return gain * std::clamp(texture(x - dx, y - dy), 0.0, 255.0) + offset +
           (noise > 0 ? noise * test::gaussian(random) : 0);
  });
  return image;
}

// The strongest corner near the middle, as a detector would choose it.
struct StrongestCorner {
  int x = kImageCentre, y = kImageCentre;
};
StrongestCorner strongest_corner(GrayView image) {
  StrongestCorner best;
  for (int y = 20; y <= 40; ++y)
    for (int x = 20; x <= 40; ++x)
      if (corner_strength(image, x, y) > corner_strength(image, best.x, best.y)) best = {x, y};
  return best;
}

TEST(Alignment, RecoversShiftsUnderChangedGainAndOffset) {
  const AlignmentOptions options;
  Random random(1);
  double worst = 0, square_sum = 0;
  int tried = 0, found = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const test::Texture texture(seed, 100, kGrain);
    const GrayImage reference = render(texture, 0, 0, 1, 0, 0, random);
    const StrongestCorner at = strongest_corner(reference.view());
    const Patch patch = cut_patch(reference.view(), at.x, at.y);
    for (int trial = 0; trial < 12; ++trial) {
      const double dx = 1.6 * random.uniform() - 0.8;
      const double dy = 1.6 * random.uniform() - 0.8;
      const GrayImage current = render(texture, dx, dy, 0.6, 30, 0, random);
      const Alignment got = align_patch(patch, kWholeWindow, current.view(), at.x, at.y, options);
      ++tried;
      if (!got.ok) continue;
      ++found;
      const double error = std::hypot(got.x - at.x - dx, got.y - at.y - dy);
      square_sum += error * error;
      worst = std::max(worst, error);
      EXPECT_LE(got.iterations, options.max_iterations);
    }
  }
  const double rms = std::sqrt(square_sum / (2 * found));
  std::printf("error %.4f px RMS an axis, %.4f px at worst, %d of %d found\n", rms, worst, found, tried);
  EXPECT_LT(rms, 0.03);
  EXPECT_LT(worst, 0.1);
  EXPECT_GE(found, tried * 90 / 100);
}

TEST(Alignment, DoesNotMoveOnTheSameImage) {
  Random random(3);
  const GrayImage image = render(test::Texture(5), 0, 0, 1, 0, 0, random);
  const Patch patch = cut_patch(image.view(), kImageCentre, kImageCentre);
  const Alignment got = align_patch(patch, kWholeWindow, image.view(), kImageCentre, kImageCentre, {});
  ASSERT_TRUE(got.ok);
  EXPECT_NEAR(got.x, kImageCentre, 1e-6);
  EXPECT_NEAR(got.y, kImageCentre, 1e-6);
  EXPECT_EQ(got.iterations, 1);
  EXPECT_LT(got.sigma_px, 0.01);
}

TEST(Alignment, RejectsPatchesWithoutTextureInTwoDirections) {
  // A flat image; one straight edge; a patch of one grey level in a textured image.
  GrayImage flat(kImageSide, kImageSide, 0, 90);
  EXPECT_FALSE(align_patch(cut_patch(flat.view(), kImageCentre, kImageCentre), kWholeWindow, flat.view(),
                           kImageCentre, kImageCentre, {})
                   .ok);
  GrayImage edge(kImageSide, kImageSide);
  edge.paint([](int x, int) { return 40 + 150 / (1 + std::exp(-(x - 30.3))); });
  EXPECT_FALSE(align_patch(cut_patch(edge.view(), kImageCentre, kImageCentre), kWholeWindow, edge.view(),
                           kImageCentre, kImageCentre, {})
                   .ok);
  Random random(8);
  const GrayImage rich = render(test::Texture(8), 0, 0, 1, 0, 0, random);
  EXPECT_FALSE(align_patch(cut_patch(flat.view(), kImageCentre, kImageCentre), kWholeWindow, rich.view(),
                           kImageCentre, kImageCentre, {})
                   .ok);
  EXPECT_FALSE(align_patch(cut_patch(rich.view(), kImageCentre, kImageCentre), kWholeWindow, flat.view(),
                           kImageCentre, kImageCentre, {})
                   .ok);
}

TEST(Alignment, RejectsADifferentPatch) {
  Random random(9);
  int accepted = 0;
  constexpr int kTrials = 100;
  for (int i = 0; i < kTrials; ++i) {
    const GrayImage a = render(test::Texture(100 + static_cast<std::uint64_t>(i)), 0, 0, 1, 0, 0, random);
    const GrayImage b = render(test::Texture(500 + static_cast<std::uint64_t>(i)), 0, 0, 1, 0, 0, random);
    const Alignment got = align_patch(cut_patch(a.view(), kImageCentre, kImageCentre), kWholeWindow, b.view(),
                                      kImageCentre, kImageCentre, {});
    EXPECT_LE(got.iterations, AlignmentOptions{}.max_iterations);
    accepted += got.ok ? 1 : 0;
  }
  EXPECT_LE(accepted, 2);
}

TEST(Alignment, NeverReadsOutsideTheImage) {
  // The image is exactly as large as its memory, so a sanitizer detects a read outside it. Starts outside the
  // image and starts that are not finite must be safe too.
  const test::Texture texture(10);
  GrayImage image(kImageSide, kImageSide);
  image.paint([&](int x, int y) { return texture(x, y); });
  const Patch patch = cut_patch(image.view(), kImageCentre, kImageCentre);
  for (double along :
       {-1e300, -100.0, -1.0, 0.0, 2.0, 3.9, kImageSide - 5.5, kImageSide - 1.0, kImageSide + 40.0, 1e300}) {
    EXPECT_FALSE(align_patch(patch, kWholeWindow, image.view(), along, kImageCentre, {}).ok) << along;
    EXPECT_FALSE(align_patch(patch, kWholeWindow, image.view(), kImageCentre, along, {}).ok) << along;
  }
  const double nan = std::nan("");
  EXPECT_FALSE(align_patch(patch, kWholeWindow, image.view(), nan, kImageCentre, {}).ok);
  EXPECT_FALSE(align_patch(patch, kWholeWindow, image.view(), kImageCentre, nan, {}).ok);
  // The registration works as near to the border as a keypoint can be.
  for (int near : {kPatchRadius + 1, kImageSide - kPatchRadius - 3}) {
    const Alignment got =
        align_patch(cut_patch(image.view(), near, near), kWholeWindow, image.view(), near, near, {});
    EXPECT_TRUE(got.ok) << near;
  }
}

TEST(Alignment, RejectsAResultFarFromItsStart) {
  // On a wide smooth blob the registration would move far; it must stop.
  GrayImage blob(kImageSide, kImageSide), far(kImageSide, kImageSide);
  const auto paint = [](double cx) {
    return [cx](int x, int y) {
      return 30 + 190 * std::exp(-((x - cx) * (x - cx) + (y - 30.0) * (y - 30.0)) / 32);
    };
  };
  blob.paint(paint(30));
  const Patch patch = cut_patch(blob.view(), kImageCentre, kImageCentre);
  far.paint(paint(34.5));
  EXPECT_FALSE(align_patch(patch, kWholeWindow, far.view(), kImageCentre, kImageCentre, {}).ok);
  AlignmentOptions patient;
  patient.max_shift_px = 8;
  patient.max_iterations = 30;
  const Alignment got = align_patch(patch, kWholeWindow, far.view(), kImageCentre, kImageCentre, patient);
  ASSERT_TRUE(got.ok) << "with more patience it is found, so the bound is what refused it";
  EXPECT_NEAR(got.x, 34.5, 0.05);
}

TEST(Alignment, StopsAtTheIterationBound) {
  Random random(13);
  const test::Texture texture(13);
  const GrayImage reference = render(texture, 0, 0, 1, 0, 0, random);
  const GrayImage current = render(texture, 0.7, -0.6, 1, 0, 0, random);
  AlignmentOptions options;
  options.tolerance_px = 0;
  for (int bound : {0, 1, 3, 8}) {
    options.max_iterations = bound;
    const Alignment got = align_patch(cut_patch(reference.view(), kImageCentre, kImageCentre), kWholeWindow,
                                      current.view(), kImageCentre, kImageCentre, options);
    EXPECT_FALSE(got.ok) << "a tolerance of zero is never met";
    EXPECT_EQ(got.iterations, bound);
  }
}

TEST(Alignment, SigmaIsTheSpreadUnderNoise) {
  // Every trial draws new noise for both images. sigma_px is that of the worse axis.
  for (double noise : {1.5, 3.0}) {
    Random random(17);
    double ratio_sum = 0;
    int textures = 0;
    for (std::uint64_t seed = 31; seed < 37; ++seed) {
      const test::Texture texture(seed, 100, kGrain);
      const StrongestCorner at = strongest_corner(render(texture, 0, 0, 1, 0, 0, random).view());
      double xx = 0, xy = 0, yy = 0, sigma_sum = 0;
      int n = 0;
      for (int trial = 0; trial < 100; ++trial) {
        const double dx = random.uniform() - 0.5;
        const double dy = random.uniform() - 0.5;
        const GrayImage reference = render(texture, 0, 0, 1, 0, noise, random);
        const GrayImage current = render(texture, dx, dy, 0.8, 10, noise, random);
        const Alignment got = align_patch(cut_patch(reference.view(), at.x, at.y), kWholeWindow,
                                          current.view(), at.x, at.y, {});
        if (!got.ok) continue;
        const double ex = got.x - at.x - dx;
        const double ey = got.y - at.y - dy;
        xx += ex * ex;
        xy += ex * ey;
        yy += ey * ey;
        sigma_sum += got.sigma_px;
        ++n;
      }
      ASSERT_GT(n, 60) << "texture " << seed;
      const double worse = std::sqrt((0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy)) / n);
      const double ratio = worse / (sigma_sum / n);
      EXPECT_GT(ratio, 0.5) << "texture " << seed << ", noise " << noise;
      EXPECT_LT(ratio, 2.0) << "texture " << seed << ", noise " << noise;
      ratio_sum += ratio;
      ++textures;
    }
    std::printf("noise %.1f: spread / sigma_px = %.2f on average\n", noise, ratio_sum / textures);
    EXPECT_NEAR(ratio_sum / textures, 1, 0.2) << "noise " << noise;
  }
}

// The texture warped about a corner, and shifted.
GrayImage render_warped(const test::Texture& texture, const StrongestCorner& about, const Matrix2& W,
                        double dx, double dy, Random& random) {
  const Matrix2 back = (Matrix2() << W(1, 1), -W(0, 1), -W(1, 0), W(0, 0)).finished() /
                       (W(0, 0) * W(1, 1) - W(0, 1) * W(1, 0));
  GrayImage image(kImageSide, kImageSide, 5);
  image.paint([&](int x, int y) {
    const Vector2 at = back * Vector2(x - about.x - dx, y - about.y - dy) + Vector2(about.x, about.y);
    return std::clamp(texture(at.x(), at.y()), 0.0, 255.0) + 0.5 * test::gaussian(random);
  });
  return image;
}

// A keyframe's patch after the camera approaches, rotates and views it obliquely.
TEST(Alignment, FollowsAPatchThatIsWarpedAsPredicted) {
  Random random(9);
  const Matrix2 warps[] = {(Matrix2() << 1.3, 0, 0, 1.3).finished(), (Matrix2() << 0.8, 0, 0, 0.8).finished(),
                           (Matrix2() << 0.94, -0.34, 0.34, 0.94).finished(),
                           (Matrix2() << 1.1, 0.2, -0.05, 0.85).finished()};
  double with = 0;
  int found = 0, found_without = 0, tried = 0;
  double without = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const test::Texture texture(seed, 100, kGrain);
    const GrayImage reference = render(texture, 0, 0, 1, 0, 0, random);
    const StrongestCorner at = strongest_corner(reference.view());
    const Patch patch = cut_patch(reference.view(), at.x, at.y);
    for (const Matrix2& W : warps) {
      const double dx = 0.37;
      const double dy = -0.21;
      const GrayImage current = render_warped(texture, at, W, dx, dy, random);
      const auto squared_error = [&](const Alignment& got) {
        return (got.x - at.x - dx) * (got.x - at.x - dx) + (got.y - at.y - dy) * (got.y - at.y - dy);
      };
      ++tried;
      const Alignment got = align_patch(patch, kWholeWindow, current.view(), at.x, at.y, {}, {W});
      if (got.ok) {
        ++found;
        with += squared_error(got);
      }
      const Alignment plain = align_patch(patch, kWholeWindow, current.view(), at.x, at.y, {});
      if (plain.ok) {
        ++found_without;
        without += squared_error(plain);
      }
    }
  }
  EXPECT_EQ(found, tried);
  EXPECT_LT(std::sqrt(with / found), 0.06);
  // Without the warp most patches are rejected, and the accepted ones have large errors.
  EXPECT_LT(found_without, tried);
  EXPECT_GT(std::sqrt(without / std::max(found_without, 1)), 3 * std::sqrt(with / found));
}

// A slight warp moves the patch itself; with any other warp the window is read pixel by pixel. On both sides
// of this limit the accuracy must be equal, and better than without the warp.
TEST(Alignment, FollowsASlightWarpAsWellAsAnyOther) {
  Random random(10);
  constexpr double kWarpBorder = 0.075;  // limit of a matrix entry; it moves a pixel at the rim by 0.3 px
  struct Kind {
    double entry;
    bool slight;
    double squared = 0, squared_without = 0;
    int found = 0;
  };
  Kind kinds[] = {{0.98 * kWarpBorder, true}, {1.02 * kWarpBorder, false}};
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const test::Texture texture(seed, 100, kGrain);
    const GrayImage reference = render(texture, 0, 0, 1, 0, 0, random);
    const StrongestCorner at = strongest_corner(reference.view());
    const Patch patch = cut_patch(reference.view(), at.x, at.y);
    const double dx = random.uniform() - 0.5, dy = random.uniform() - 0.5;
    for (Kind& kind : kinds) {
      const double e = kind.entry;
      for (const Matrix2& W :
           {(Matrix2() << 1 + e, 0, 0, 1 + e).finished(), (Matrix2() << 1, -e, e, 1).finished(),
            (Matrix2() << 1, e, 0, 1 - e).finished()}) {
        ASSERT_EQ(PatchWarp{W}.is_slight(), kind.slight);
        const GrayImage current = render_warped(texture, at, W, dx, dy, random);
        const auto squared_error = [&](const Alignment& got) {
          EXPECT_TRUE(got.ok);
          return (got.x - at.x - dx) * (got.x - at.x - dx) + (got.y - at.y - dy) * (got.y - at.y - dy);
        };
        kind.squared += squared_error(align_patch(patch, kWholeWindow, current.view(), at.x, at.y, {}, {W}));
        kind.squared_without +=
            squared_error(align_patch(patch, kWholeWindow, current.view(), at.x, at.y, {}));
        ++kind.found;
      }
    }
  }
  double rms[2];
  for (int i = 0; i < 2; ++i) {
    rms[i] = std::sqrt(kinds[i].squared / kinds[i].found);
    const double without = std::sqrt(kinds[i].squared_without / kinds[i].found);
    std::printf("%s: %.4f px, without its warp %.4f px\n", kinds[i].slight ? "slight" : "read by pixels",
                rms[i], without);
    EXPECT_LT(rms[i], 0.04);
    EXPECT_GT(without, 5 * rms[i]);
  }
  EXPECT_LT(rms[0], 1.5 * rms[1]);
}

TEST(Alignment, RejectsImpossibleWarps) {
  Random random(11);
  const test::Texture texture(5, 100, kGrain);
  const GrayImage image = render(texture, 0, 0, 1, 0, 0, random);
  const Patch patch = cut_patch(image.view(), kImageCentre, kImageCentre);
  const double nan = std::nan("");
  for (const Matrix2& W : {(Matrix2() << 4, 0, 0, 4).finished(), (Matrix2() << 0.1, 0, 0, 0.1).finished(),
                           (Matrix2() << 1, 0, 0, -1).finished(), (Matrix2() << nan, 0, 0, 1).finished(),
                           (Matrix2() << 1e300, 0, 0, 1e300).finished()})
    EXPECT_FALSE(align_patch(patch, kWholeWindow, image.view(), kImageCentre, kImageCentre, {}, {W}).ok);
}

}  // namespace
}  // namespace plvo
