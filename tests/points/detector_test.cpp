// SPDX-License-Identifier: Apache-2.0
// Compares the detector with a plain implementation of its rule, and tests its invariance to light, its
// positions and its capacity.
#include "plvo/points/detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <vector>

#include "gray_image.hpp"
#include "plvo/points/fast.hpp"
#include "texture.hpp"

namespace plvo {
namespace {

using test::GrayImage;

constexpr int kWidth = 257;
constexpr int kHeight = 199;

// Pyramid, depth and scratch memory of one image. Depth is 1 m at every pixel that is not cleared.
class DetectorFrame {
 public:
  explicit DetectorFrame(const GrayImage& image) : depth_(kWidth * kHeight, 1000), memory_(bytes()) {
    Arena arena(memory_);
    pyramid.allocate(arena, kWidth, kHeight);
    pyramid.init(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) pyramid.base().at(x, y) = image.view().at(x, y);
    pyramid.build();
  }
  DepthSampler depth() const { return {{depth_.data(), kWidth, kHeight, kWidth, 0.001}, map_, {}}; }
  void clear_depth(int x, int y) { depth_[static_cast<std::size_t>(y * kWidth + x)] = 0; }

  Pyramid pyramid;

 private:
  static std::size_t bytes() {
    Arena sizer = Arena::counting();
    Pyramid counted;
    counted.allocate(sizer, kWidth, kHeight);
    return sizer.peak() + kArenaAlignment;
  }
  std::vector<std::uint16_t> depth_;
  std::vector<std::byte> memory_;
  UndistortionMap map_;
};

struct Detection {
  std::vector<Keypoint> keypoints;
  std::size_t dropped = 0;
  int candidates = 0;
};

Detection detect(const DetectorFrame& frame, const DetectorConfig& options, std::size_t capacity) {
  Arena sizer = Arena::counting();
  reserve_detection(sizer, kWidth, kHeight);
  std::vector<std::byte> memory(sizer.peak() + kArenaAlignment);
  Arena scratch(memory);
  std::vector<Keypoint> storage(capacity);
  FixedVector<Keypoint> out(storage);
  const DetectionSummary summary = detect_keypoints(frame.pyramid, frame.depth(), options, scratch, out);
  EXPECT_FALSE(scratch.exhausted());
  EXPECT_EQ(scratch.used(), 0U);
  return {{out.begin(), out.end()}, out.dropped(), summary.candidates};
}

int score(GrayView image, int x, int y) {
  std::uint8_t value = 0;
  segment_test_row(image.row(y) + x, image.stride, 1, 0, &value);
  return value;
}

// Whether the pixel has the greatest score of its 3×3 neighbourhood; of equal scores the first in reading
// order wins.
bool is_maximum(GrayView image, int x, int y) {
  const int centre = score(image, x, y);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      const bool before = dy < 0 || (dy == 0 && dx < 0);
      const int other = score(image, x + dx, y + dy);
      if (other > centre || (before && other == centre)) return false;
    }
  return true;
}

// (rank, −strength, level, y, x): the order in which candidates are kept.
using Place = std::tuple<int, float, int, int, int>;

std::vector<Place> reference_candidates(const DetectorFrame& frame, const DetectorConfig& options) {
  std::vector<Place> all;
  const DepthSampler depth = frame.depth();
  for (int level = 0; level < options.levels; ++level) {
    const GrayView image = frame.pyramid.level(level);
    for (int y0 = kKeypointMargin; y0 < image.height - kKeypointMargin; y0 += options.cell_px)
      for (int x0 = kKeypointMargin; x0 < image.width - kKeypointMargin; x0 += options.cell_px) {
        const int x1 = std::min(x0 + options.cell_px, image.width - kKeypointMargin);
        const int y1 = std::min(y0 + options.cell_px, image.height - kKeypointMargin);
        int low = 255, high = 0;
        for (int y = y0; y < y1; y += 2)
          for (int x = x0; x < x1; x += 2) {
            low = std::min<int>(low, image.at(x, y));
            high = std::max<int>(high, image.at(x, y));
          }
        int threshold = std::max(options.noise_floor, (high - low) / 8);
        const auto count = [&] {
          int n = 0;
          for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) n += score(image, x, y) > threshold ? 1 : 0;
          return n;
        };
        while (threshold > options.noise_floor && count() < 3 * kKeypointsPerCell)
          threshold = std::max(options.noise_floor, threshold / 2);
        std::vector<Place> cell;
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            if (score(image, x, y) <= threshold || !is_maximum(image, x, y)) continue;
            const auto strength = static_cast<float>(corner_strength(image, x, y));
            if (static_cast<double>(strength) < options.min_strength) continue;
            if (depth.near(x << level, y << level) <= 0) continue;
            cell.emplace_back(0, -strength, level, y, x);
          }
        std::sort(cell.begin(), cell.end());
        if (cell.size() > kKeypointsPerCell) cell.resize(kKeypointsPerCell);
        for (std::size_t i = 0; i < cell.size(); ++i) {
          std::get<0>(cell[i]) = static_cast<int>(i);
          all.push_back(cell[i]);
        }
      }
  }
  return all;
}

GrayImage textured(std::uint64_t seed, double noise = 1.5) {
  Random random(seed);
  const test::Texture texture(seed, 70);
  GrayImage image(kWidth, kHeight);
  image.paint([&](int x, int y) { return texture(x, y) + noise * test::gaussian(random); });
  return image;
}

TEST(CornerStrength, IsTheSmallerEigenvalueOfTheMeanStructureTensor) {
  Random random(2);
  const GrayImage image = test::random_image(40, 30, random, 3);
  for (int y = 4; y < 26; ++y)
    for (int x = 4; x < 36; ++x) {
      double xx = 0, xy = 0, yy = 0;
      for (int j = y - 3; j <= y + 3; ++j)
        for (int i = x - 3; i <= x + 3; ++i) {
          const double gx = 0.5 * (image.view().at(i + 1, j) - image.view().at(i - 1, j));
          const double gy = 0.5 * (image.view().at(i, j + 1) - image.view().at(i, j - 1));
          xx += gx * gx / 49;
          xy += gx * gy / 49;
          yy += gy * gy / 49;
        }
      const double trace = xx + yy;
      const double smaller = 0.5 * (trace - std::sqrt(trace * trace - 4 * (xx * yy - xy * xy)));
      ASSERT_NEAR(corner_strength(image.view(), x, y), smaller, 1e-9 * trace);
    }
}

TEST(Detector, KeepsTheSameKeypointsAsTheReference) {
  for (std::uint64_t seed : {11U, 12U, 13U}) {
    DetectorFrame frame(textured(seed, seed == 13 ? 6 : 1.5));
    Random random(seed);
    for (int i = 0; i < 8000; ++i)
      frame.clear_depth(static_cast<int>(random.below(kWidth)), static_cast<int>(random.below(kHeight)));
    DetectorConfig options;
    options.cell_px = seed == 12 ? 24 : 40;
    options.levels = seed == 12 ? 4 : 3;
    std::vector<Place> expected = reference_candidates(frame, options);
    ASSERT_GT(expected.size(), 100U);
    std::sort(expected.begin(), expected.end());
    for (std::size_t capacity :
         {std::size_t{1}, std::size_t{37}, expected.size() - 1, expected.size(), std::size_t{5000}}) {
      const Detection got = detect(frame, options, capacity);
      const std::size_t kept = std::min(capacity, expected.size());
      ASSERT_EQ(got.keypoints.size(), kept);
      EXPECT_EQ(got.dropped, expected.size() - kept);
      EXPECT_GE(got.candidates, static_cast<int>(expected.size()));
      // Only the set of keypoints is specified, not their order.
      std::vector<std::tuple<int, int, int>> got_places, expected_places;
      for (const Keypoint& k : got.keypoints) got_places.emplace_back(k.level, k.y, k.x);
      for (std::size_t i = 0; i < kept; ++i)
        expected_places.emplace_back(std::get<2>(expected[i]), std::get<3>(expected[i]),
                                     std::get<4>(expected[i]));
      std::sort(got_places.begin(), got_places.end());
      std::sort(expected_places.begin(), expected_places.end());
      EXPECT_EQ(got_places, expected_places);
    }
  }
}

TEST(Detector, KeypointsAreOffTheBorderAndRefinedByLessThanHalfAPixel) {
  const DetectorFrame frame(textured(21));
  const Detection got = detect(frame, {}, 2000);
  ASSERT_GT(got.keypoints.size(), 100U);
  int levels[3] = {};
  for (const Keypoint& k : got.keypoints) {
    const GrayView image = frame.pyramid.level(k.level);
    EXPECT_TRUE(k.x >= kKeypointMargin && k.x < image.width - kKeypointMargin);
    EXPECT_TRUE(k.y >= kKeypointMargin && k.y < image.height - kKeypointMargin);
    const float scale = static_cast<float>(1 << k.level);
    EXPECT_LE(std::abs(k.u / scale - k.x), 0.5F);
    EXPECT_LE(std::abs(k.v / scale - k.y), 0.5F);
    EXPECT_FLOAT_EQ(k.strength, static_cast<float>(corner_strength(image, k.x, k.y)));
    ++levels[k.level];
  }
  for (int count : levels) EXPECT_GT(count, 0);
}

TEST(Detector, FindsNothingWithoutDepthOrTexture) {
  DetectorFrame blind(textured(22));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) blind.clear_depth(x, y);
  EXPECT_TRUE(detect(blind, {}, 500).keypoints.empty());
  EXPECT_EQ(detect(blind, {}, 500).dropped, 0U);
  const DetectorFrame bare(GrayImage(kWidth, kHeight, 0, 77));
  EXPECT_TRUE(detect(bare, {}, 500).keypoints.empty());
  EXPECT_EQ(detect(bare, {}, 500).candidates, 0);
}

TEST(Detector, FindsTheSameCornersInDimLight) {
  // The same scene at full light and at 40 %, with sensor noise of the same SD.
  const test::Texture texture(31, 70);
  Random random(32);
  const auto render = [&](double light) {
    GrayImage image(kWidth, kHeight);
    image.paint([&](int x, int y) { return light * texture(x, y) + 0.7 * test::gaussian(random); });
    return image;
  };
  const auto repeated = [](const Detection& of, const Detection& in) {
    int count = 0;
    for (const Keypoint& a : of.keypoints)
      count += std::any_of(in.keypoints.begin(), in.keypoints.end(),
                           [&](const Keypoint& b) {
                             const float reach = 1.5F * static_cast<float>(1 << a.level);
                             return a.level == b.level && std::hypot(a.u - b.u, a.v - b.v) <= reach;
                           })
                   ? 1
                   : 0;
    return count / static_cast<double>(of.keypoints.size());
  };
  const Detection bright = detect(DetectorFrame(render(1)), {}, 250);
  const Detection again = detect(DetectorFrame(render(1)), {}, 250);
  const Detection dim = detect(DetectorFrame(render(0.4)), {}, 250);
  std::printf("repeated: %.2f in the same light, %.2f at 40 %%; %zu and %zu keypoints\n",
              repeated(bright, again), repeated(bright, dim), bright.keypoints.size(), dim.keypoints.size());
  EXPECT_GT(dim.keypoints.size(), bright.keypoints.size() * 8 / 10);
  EXPECT_GT(repeated(bright, dim), 0.7);
}

TEST(Detector, KeepsAKeypointInEveryTexturedCell) {
  // The capacity is the number of cells of level 0. Every cell with a corner keeps its best one, however
  // strong the corners elsewhere are.
  GrayImage image = textured(41);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x)
      image.view().at(x, y) = static_cast<std::uint8_t>(60 + image.view().at(x, y) / 2);
  DetectorConfig options;
  options.levels = 1;
  const std::size_t cells = detection_cells(kWidth, kHeight, options.cell_px);
  const Detection got = detect(DetectorFrame(image), options, cells);
  ASSERT_EQ(got.keypoints.size(), cells);
  std::vector<int> count(cells);
  for (const Keypoint& k : got.keypoints) {
    const int column = (k.x - kKeypointMargin) / options.cell_px;
    const int row = (k.y - kKeypointMargin) / options.cell_px;
    const int columns = (kWidth - 2 * kKeypointMargin + options.cell_px - 1) / options.cell_px;
    ++count[static_cast<std::size_t>(row * columns + column)];
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), static_cast<std::ptrdiff_t>(cells));
}

TEST(Detector, LocatesRenderedCornersWithSubPixelAccuracy) {
  // A bright square on dark ground, with edges blended by area, at known sub-pixel positions. The strength of
  // a corner peaks slightly inside it; the test checks that the keypoint moves with the corner.
  DetectorConfig options;
  options.levels = 1;
  double square_sum = 0, worst = 0;
  int n = 0;
  double bias_u = 0, bias_v = 0;
  std::vector<Vector2> errors;
  for (int step = 0; step < 25; ++step) {
    const double cx = 100 + 0.2 * (step % 5);
    const double cy = 90 + 0.2 * (step / 5);
    GrayImage image(kWidth, kHeight);
    const auto covered = [](int pixel, double from) { return std::clamp(pixel + 0.5 - from, 0.0, 1.0); };
    image.paint([&](int x, int y) {
      const double right = 1 - covered(x, cx + 60);
      const double bottom = 1 - covered(y, cy + 50);
      return 40 + 160 * covered(x, cx) * right * covered(y, cy) * bottom;
    });
    const Detection got = detect(DetectorFrame(image), options, 100);
    const Keypoint* nearest = nullptr;
    for (const Keypoint& k : got.keypoints)
      if (nearest == nullptr ||
          std::hypot(static_cast<double>(k.u) - cx, static_cast<double>(k.v) - cy) <
              std::hypot(static_cast<double>(nearest->u) - cx, static_cast<double>(nearest->v) - cy))
        nearest = &k;
    ASSERT_NE(nearest, nullptr);
    errors.emplace_back(static_cast<double>(nearest->u) - cx, static_cast<double>(nearest->v) - cy);
    bias_u += errors.back().x();
    bias_v += errors.back().y();
    ++n;
  }
  const Vector2 bias(bias_u / n, bias_v / n);
  for (const Vector2& error : errors) {
    square_sum += (error - bias).squaredNorm();
    worst = std::max(worst, (error - bias).norm());
  }
  std::printf("corners: bias (%.2f, %.2f) px, spread %.3f px an axis, worst %.3f px\n", bias.x(), bias.y(),
              std::sqrt(square_sum / (2 * n)), worst);
  EXPECT_LT(bias.norm(), 2.5);
  EXPECT_LT(std::sqrt(square_sum / (2 * n)), 0.4) << "about half a pixel, as alignment.hpp says";
  EXPECT_LT(worst, 0.8);
}

}  // namespace
}  // namespace plvo
