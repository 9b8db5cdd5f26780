// SPDX-License-Identifier: Apache-2.0
// The registration must not favour some fractions of a pixel: all points of a frame share the fraction, so
// the bias would look like a motion. It must also ignore the surface that the depth mask excludes.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <vector>

#include "gray_image.hpp"
#include "plvo/points/alignment.hpp"
#include "plvo/points/descriptor.hpp"
#include "plvo/points/detector.hpp"
#include "texture.hpp"
#include "whole_window.hpp"

namespace plvo {
namespace {

using test::GrayImage;
using test::kWholeWindow;

constexpr int kSide = 150;
constexpr int kCell = 15;
constexpr int kBorder = 12;
constexpr double kFineGrain = 0.3;  // grains of 1.5 px and more

// The texture shifted by (dx, dy). Each pixel is the mean over its square.
GrayImage render(const test::Texture& texture, double dx, double dy, int side = kSide) {
  GrayImage image(side, side);
  constexpr int kSamples = 3;
  image.paint([&](int x, int y) {
    double sum = 0;
    for (int j = 0; j < kSamples; ++j)
      for (int i = 0; i < kSamples; ++i)
        sum += texture(x - dx + (i - 1.0) / kSamples, y - dy + (j - 1.0) / kSamples);
    return sum / (kSamples * kSamples);
  });
  return image;
}

struct Corner {
  int x, y;
};
// The strongest corner of every cell.
std::vector<Corner> corners(GrayView image) {
  std::vector<Corner> all;
  for (int top = kBorder; top + kCell <= image.height - kBorder; top += kCell)
    for (int left = kBorder; left + kCell <= image.width - kBorder; left += kCell) {
      Corner best{left, top};
      for (int y = top; y < top + kCell; ++y)
        for (int x = left; x < left + kCell; ++x)
          if (corner_strength(image, x, y) > corner_strength(image, best.x, best.y)) best = {x, y};
      all.push_back(best);
    }
  return all;
}

// The usual registration with a raw template and bilinear interpolation. Its bias shows that the textures are
// fine enough for this test.
double bilinear_registration(GrayView reference, GrayView current, const Corner& at) {
  double x = at.x, y = at.y;
  for (int iteration = 0; iteration < 10; ++iteration) {
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const double fx = x - x0, fy = y - y0;
    Matrix4 N = Matrix4::Zero();
    Vector4 b = Vector4::Zero();
    for (int j = -kWindowReach; j <= kWindowReach; ++j)
      for (int i = -kWindowReach; i < kWindowReach; ++i) {
        const auto T = [&](int dx, int dy) { return reference.at(at.x + i + dx, at.y + j + dy); };
        const auto I = [&](int dx, int dy) { return current.at(x0 + i + dx, y0 + j + dy); };
        const Vector4 regressor(0.5 * (T(1, 0) - T(-1, 0)), 0.5 * (T(0, 1) - T(0, -1)), T(0, 0) - 127.0, 1);
        const double value =
            (1 - fy) * ((1 - fx) * I(0, 0) + fx * I(1, 0)) + fy * ((1 - fx) * I(0, 1) + fx * I(1, 1));
        N += regressor * regressor.transpose();
        b += value * regressor;
      }
    const Vector4 solution = Eigen::Matrix4d(N).ldlt().solve(b);
    x -= solution[0] / solution[2];
    y -= solution[1] / solution[2];
    if (!(std::hypot(x - at.x, y - at.y) < 3)) return std::nan("");
  }
  return x;
}

TEST(AlignmentBias, HasNoBiasAtAnyFractionOfAPixel) {
  std::vector<test::Texture> textures;
  std::vector<GrayImage> references;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    textures.emplace_back(seed, 100, kFineGrain);
    references.push_back(render(textures.back(), 0, 0));
  }
  double worst = 0, worst_bilinear = 0;
  for (int eighths = 0; eighths < 8; ++eighths) {
    // The shift is along x only, because the bias of one axis does not depend on the fraction of the other.
    const double shift = eighths / 8.0;
    double error_sum = 0, bilinear_sum = 0;
    int found = 0, found_bilinear = 0, tried = 0;
    for (std::size_t t = 0; t < textures.size(); ++t) {
      const GrayImage& reference = references[t];
      const GrayImage current = render(textures[t], shift, 0);
      for (const Corner& at : corners(reference.view())) {
        ++tried;
        const Alignment got = align_patch(cut_patch(reference.view(), at.x, at.y), kWholeWindow,
                                          current.view(), at.x + 0.5, at.y, {});
        if (got.ok && std::fabs(got.x - at.x - shift) < 0.5) {
          error_sum += got.x - at.x - shift;
          ++found;
        }
        const double bilinear = bilinear_registration(reference.view(), current.view(), at);
        if (std::fabs(bilinear - at.x - shift) < 0.5) {
          bilinear_sum += bilinear - at.x - shift;
          ++found_bilinear;
        }
      }
    }
    ASSERT_GT(found, tried * 8 / 10);
    ASSERT_GT(found_bilinear, tried / 2);
    const double mean = error_sum / found;
    const double mean_bilinear = bilinear_sum / found_bilinear;
    std::printf("fraction %d/8: mean error %+.4f px, with bilinear reading %+.4f px (%d of %d found)\n",
                eighths, mean, mean_bilinear, found, tried);
    EXPECT_LT(std::fabs(mean), 0.005) << eighths << "/8";
    worst = std::max(worst, std::fabs(mean));
    worst_bilinear = std::max(worst_bilinear, std::fabs(mean_bilinear));
  }
  EXPECT_GT(worst_bilinear, 5 * worst) << "the textures are too smooth to tell";
}

// Two surfaces meet two pixels right of the middle of the patch. Each moves by its own shift.
constexpr int kSmall = 60;
constexpr int kCentre = 30;
struct TwoSurfaces {
  explicit TwoSurfaces(std::uint64_t seed) : own(seed, 100, 1.2), other(seed + 1000, 100, 1.2) {}
  GrayImage render(double own_dx, double own_dy, double other_dx, double other_dy) const {
    GrayImage image(kSmall, kSmall);
    image.paint([&](int x, int y) {
      return x < kCentre + 2 ? own(x - own_dx, y - own_dy) : other(x - other_dx, y - other_dy);
    });
    return image;
  }
  test::Texture own, other;
};

constexpr WindowMask kLeftHalf = {15, 15, 15, 15, 15, 15, 15, 15, 15};

TEST(AlignmentMask, FollowsTheUnmaskedHalfOfThePatch) {
  double masked_sum = 0;
  int found = 0, misled = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    const TwoSurfaces scene(static_cast<std::uint64_t>(trial + 1));
    const GrayImage reference = scene.render(0, 0, 0, 0);
    // The half on the own surface moves by a fraction of a pixel, the other half moves the opposite way.
    const double dx = 0.05 + 0.005 * trial, dy = 0.3 - 0.005 * trial;
    const GrayImage current = scene.render(dx, dy, -1.1, -0.9);
    const Patch patch = cut_patch(reference.view(), kCentre, kCentre);
    const Alignment masked = align_patch(patch, kLeftHalf, current.view(), kCentre, kCentre, {});
    const Alignment whole = align_patch(patch, kWholeWindow, current.view(), kCentre, kCentre, {});
    if (masked.ok) {
      ++found;
      masked_sum += std::pow(masked.x - kCentre - dx, 2) + std::pow(masked.y - kCentre - dy, 2);
    }
    if (!whole.ok || std::hypot(whole.x - kCentre - dx, whole.y - kCentre - dy) > 0.15) ++misled;
  }
  const double rms = std::sqrt(masked_sum / (2 * found));
  std::printf("own half alone: %.4f px RMS an axis, %d of %d found; the whole window is misled in %d\n", rms,
              found, kTrials, misled);
  EXPECT_GT(found, kTrials * 8 / 10);
  EXPECT_LT(rms, 0.03);
  EXPECT_GT(misled, kTrials / 2) << "the other half must be able to mislead";
}

TEST(AlignmentMask, ResultDoesNotDependOnMaskedPixels) {
  // The masked half of both images may hold any grey levels beyond the support of the spline.
  const TwoSurfaces one(5);
  TwoSurfaces two(5);
  two.other = test::Texture(77, 100, 1.2);
  const Patch patch = cut_patch(one.render(0, 0, 0, 0).view(), kCentre, kCentre);
  const Patch patch_two = cut_patch(two.render(0, 0, 0, 0).view(), kCentre, kCentre);
  const Alignment a = align_patch(patch, kLeftHalf, one.render(0.3, 0.2, 0, 0).view(), kCentre, kCentre, {});
  const Alignment b =
      align_patch(patch_two, kLeftHalf, two.render(0.3, 0.2, 0, 0).view(), kCentre, kCentre, {});
  ASSERT_TRUE(a.ok);
  ASSERT_TRUE(b.ok);
  EXPECT_NEAR(a.x, b.x, 1e-3);
  EXPECT_NEAR(a.y, b.y, 1e-3);
  EXPECT_NEAR(a.sigma_px, b.sigma_px, 1e-3);
}

TEST(AlignmentMask, RejectsAMaskWithFewerThanAThirdOfThePixels) {
  const test::Texture texture(4, 100, 0.8);
  const GrayImage image = render(texture, 0, 0, kSmall);
  const Patch patch = cut_patch(image.view(), kCentre, kCentre);
  WindowMask third = {0, 0, 0, 255, 255, 255, 0, 0, 0};
  EXPECT_TRUE(align_patch(patch, third, image.view(), kCentre, kCentre, {}).ok);
  third[3] = 254;
  EXPECT_FALSE(align_patch(patch, third, image.view(), kCentre, kCentre, {}).ok);
  EXPECT_FALSE(align_patch(patch, WindowMask{}, image.view(), kCentre, kCentre, {}).ok);
}

}  // namespace
}  // namespace plvo
