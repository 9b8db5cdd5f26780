// SPDX-License-Identifier: Apache-2.0
// Tests the segment detector at its limits: bounds of time and memory, capacity, invalid arguments, unusual
// images; and compares its stated uncertainty with its errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "line_picture.hpp"
#include "plvo/lines/lsd/edge_localisation.hpp"

namespace plvo {
namespace {

using test::DetectorRig;
using test::Picture;

static_assert(SegmentDetector::scratch_bytes(320, 240) <= 2'500'000, "half of VGA");
static_assert(SegmentDetector::scratch_bytes(320, 240) > 1'000'000);

// Tests the bound that lsd.hpp states on difficult images.
TEST(SegmentDetectorLimits, GrownPixelsStayWithinTheBound) {
  Random random(1);
  for (const int cell : {1, 2, 3, 4, 6, 8, 16}) {
    for (const double noise : {0.0, 4.0, 25.0}) {
      Picture picture(320, 240, 0);
      for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) picture.at(x, y) = (x / cell + y / cell) % 2 == 0 ? 40 : 210;
      }
      DetectorRig rig(320, 240);
      rig.detect(test::expose(picture, noise, random));
      EXPECT_LE(rig.counts().grown_pixels,
                std::int64_t{lsd::kMaxReleases + 1} * rig.counts().directed_pixels);
      // In practice the number is far below the bound.
      EXPECT_LE(rig.counts().grown_pixels, 3 * std::int64_t{rig.counts().directed_pixels})
          << cell << " " << noise;
    }
  }
}

TEST(SegmentDetectorLimits, RingsAndSpokesStayWithinTheBound) {
  Random random(2);
  for (const bool rings : {true, false}) {
    Picture picture(320, 240, 0);
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const double phase = rings ? std::hypot(x - 160, y - 120) / 5 : 24 * std::atan2(y - 120, x - 160);
        picture.at(x, y) = 128 + 100 * std::sin(phase);
      }
    }
    DetectorRig rig(320, 240);
    const auto& segments = rig.detect(test::expose(picture, 2, random));
    EXPECT_LE(rig.counts().grown_pixels, 3 * std::int64_t{rig.counts().directed_pixels});
    for (const Segment& s : segments) EXPECT_TRUE(s.a.allFinite() && s.b.allFinite() && s.sigma_px > 0);
  }
}

TEST(SegmentDetectorLimits, FindsNothingInTinyAndFlatImages) {
  for (const int width : {1, 2, 3, 5, 9, 17}) {
    for (const int height : {1, 2, 3, 5, 9, 17}) {
      DetectorRig rig(width, height);
      std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width * height), 77);
      EXPECT_EQ(rig.detect(pixels).size(), 0U);
      for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 2 == 0 ? 0 : 255;
      rig.detect(pixels);  // only has to return
    }
  }
  DetectorRig rig(640, 480);
  EXPECT_EQ(rig.detect(std::vector<std::uint8_t>(640 * 480, 255)).size(), 0U);
  EXPECT_EQ(rig.counts().directed_pixels, 0);
}

TEST(SegmentDetectorLimits, RejectsInvalidArguments) {
  std::vector<std::byte> memory(SegmentDetector::scratch_bytes(32, 24) + kArenaAlignment);
  std::vector<std::uint8_t> pixels(64 * 48, 10);
  const GrayView full{pixels.data(), 64, 48, 64};
  const GrayView half{pixels.data(), 32, 24, 64};
  std::vector<Segment> storage(8);
  FixedVector<Segment> out(storage);
  const SegmentDetector detector(32, 24);
  Arena arena(memory);
  EXPECT_TRUE(detector.detect(half, 2, full, arena, out).ok());
  EXPECT_EQ(detector.detect(full, 1, full, arena, out).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(detector.detect({}, 2, full, arena, out).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(detector.detect(half, 2, {}, arena, out).code(), StatusCode::kInvalidArgument);
  Arena small(std::span<std::byte>(memory).first(memory.size() / 2));
  EXPECT_EQ(detector.detect(half, 2, full, small, out).code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(small.used(), 0U);

  const int most = lsd::LevelLineField::kMostWidth;
  std::vector<std::uint8_t> wide_pixels(static_cast<std::size_t>(most + 1) * 2, 10);
  std::vector<std::byte> more(SegmentDetector::scratch_bytes(most + 1, 2) + kArenaAlignment);
  Arena enough(more);
  for (const int width : {most, most + 1}) {
    const GrayView wide{wide_pixels.data(), width, 2, width};
    EXPECT_EQ(SegmentDetector(width, 2).detect(wide, 1, wide, enough, out).ok(), width == most);
  }
}

// The image has a dense grid of strong squares on the left and two faint squares on the right. A detector
// with small capacity must keep the faint ones.
TEST(SegmentDetectorLimits, KeepsTheMostMeaningfulAndSpreadsTheRest) {
  Picture picture(640, 480, 100);
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 6; ++i) {
      test::fill_polygon(picture, test::regular_polygon(Vector2(40 + 50 * i, 50 + 55 * j), 4, 24, 0.3), 250);
    }
  }
  test::fill_polygon(picture, test::regular_polygon(Vector2(540, 120), 4, 40, 0.2), 130);
  test::fill_polygon(picture, test::regular_polygon(Vector2(540, 380), 4, 40, 0.7), 130);
  Random random(4);
  const auto pixels = test::expose(picture, 1, random);

  DetectorRig roomy(640, 480);
  const auto& all = roomy.detect(pixels);
  EXPECT_EQ(all.dropped(), 0U);
  ASSERT_GT(all.size(), 190U);
  DetectorRig tight(640, 480, 60);
  const auto& kept = tight.detect(pixels);
  ASSERT_EQ(kept.size(), 60U);
  EXPECT_EQ(kept.dropped(), all.size() - 60);
  int faint = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    faint += kept[i].middle().x() > 400 ? 1 : 0;
    if (i > 0) {
      EXPECT_LE(kept[i].meaningfulness, kept[i - 1].meaningfulness);
    }
  }
  EXPECT_EQ(faint, 8);
  // Half of the capacity is for the most meaningful segments, wherever they are.
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(kept[i].meaningfulness, all[i].meaningfulness);
}

// The three bands of an image of 240 rows meet at rows 80 and 160; no shape crosses these rows.
Picture shapes_between_the_borders() {
  Picture picture(320, 240, 100);
  for (int band = 0; band < 3; ++band) {
    for (int i = 0; i < 4; ++i) {
      const Vector2 centre(40 + 65 * i, 40 + 80 * band);
      test::fill_polygon(picture, test::regular_polygon(centre, 3 + i, 24, 0.3 * i), i % 2 == 0 ? 160 : 50);
    }
  }
  return picture;
}

TEST(SegmentDetectorLimits, BandsSplitOnlySegmentsThatCrossThem) {
  Random random(11);
  Picture picture = shapes_between_the_borders();
  const auto detect = [](const std::vector<std::uint8_t>& pixels, const SegmentSearch& search) {
    DetectorRig rig(320, 240, 256, search);
    const auto& found = rig.detect(pixels);
    std::vector<Segment> sorted(found.begin(), found.end());
    // Equal shapes in two bands have equal meaningfulness, so the order is by position.
    std::sort(sorted.begin(), sorted.end(), [](const Segment& p, const Segment& q) {
      return p.a.y() != q.a.y() ? p.a.y() < q.a.y() : p.a.x() < q.a.x();
    });
    return sorted;
  };
  const SegmentSearch whole{160, 120}, bands{160, 120, 3};
  EXPECT_LT(SegmentDetector::scratch_bytes(bands), SegmentDetector::scratch_bytes(whole) / 2);
  const auto apart = test::expose(picture, 0.5, random);
  const auto all = detect(apart, whole);
  const auto in_bands = detect(apart, bands);
  EXPECT_GT(all.size(), 40U);
  ASSERT_EQ(in_bands.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(in_bands[i].a, all[i].a);
    EXPECT_EQ(in_bands[i].b, all[i].b);
  }
  // A bar from top to bottom has two edges in the whole image, and two in each of the three bands.
  test::fill_polygon(picture, {{295, 10}, {305, 10}, {305, 230}, {295, 230}}, 220);
  const auto crossed = test::expose(picture, 0.5, random);
  const auto upright = [](const std::vector<Segment>& segments) {
    return std::count_if(segments.begin(), segments.end(), [](const Segment& s) {
      return s.middle().x() > 285 && std::abs(s.direction().y()) > 0.99 && s.length_px() > 40;
    });
  };
  EXPECT_EQ(upright(detect(crossed, whole)), 2);
  EXPECT_EQ(upright(detect(crossed, bands)), 6);
}

TEST(SegmentDetectorLimits, CountsCandidatesBeyondTheCapacity) {
  Random random(12);
  const auto pixels = test::expose(shapes_between_the_borders(), 0.5, random);
  DetectorRig roomy(320, 240);
  const std::size_t all = roomy.detect(pixels).size();
  DetectorRig tight(320, 240, 256, {160, 120, 1, 20});
  const auto& kept = tight.detect(pixels);
  EXPECT_EQ(kept.size(), 20U);
  EXPECT_EQ(kept.dropped(), all - 20);
}

TEST(SegmentDetectorLimits, IsDeterministic) {
  Picture picture(320, 240, 100);
  test::fill_polygon(picture, test::regular_polygon(Vector2(160, 120), 5, 90, 0.3), 150);
  Random random(9);
  const auto pixels = test::expose(picture, 5, random);
  DetectorRig first(320, 240);
  DetectorRig second(320, 240);
  second.detect(std::vector<std::uint8_t>(320 * 240, 3));
  const auto& a = first.detect(pixels);
  const auto& b = second.detect(pixels);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].a, b[i].a);
    EXPECT_EQ(a[i].b, b[i].b);
    EXPECT_EQ(a[i].sigma_px, b[i].sigma_px);
  }
}

// A step edge has a known position; the initial segment is somewhat off it.
TEST(Localise, StatedUncertaintyMatchesTheErrors) {
  Random random(12);
  double offset_nees = 0;
  double angle_nees = 0;
  int placed = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double angle = 2 * kPi * random.uniform();
    const Vector2 d(std::cos(angle), std::sin(angle));
    const Vector2 n(-d.y(), d.x());
    const Vector2 middle(48 + random.uniform(), 48 + random.uniform());
    const double noise = 2 + 4 * random.uniform();
    Picture picture(96, 96, 0);
    for (int y = 0; y < 96; ++y) {
      for (int x = 0; x < 96; ++x) {
        const double t = n.dot(Vector2(x, y) - middle);
        picture.at(x, y) = 130 + 40 * std::tanh(t / 1.2);  // a blurred edge, brighter along n
      }
    }
    const auto pixels = test::expose(picture, noise, random);
    const Vector2 off = n * 0.3 * test::gaussian_noise(random);
    const double half = 15 + 15 * random.uniform();
    const double turn = 0.3 / half * test::gaussian_noise(random);
    const Vector2 e = d + turn * n;
    Segment s;
    s.a = middle - half * e + off;
    s.b = middle + half * e + off;
    if (!lsd::localise({pixels.data(), 96, 96, 96}, 0.3, s)) continue;
    ++placed;
    const double offset = n.dot(s.middle() - middle);
    const double angle_error = std::asin(n.dot(s.direction()));
    EXPECT_LT(std::abs(offset), 0.7);
    offset_nees += offset * offset / (s.sigma_px * s.sigma_px);
    angle_nees += angle_error * angle_error / (s.sigma_angle_rad * s.sigma_angle_rad);
  }
  EXPECT_GT(placed, kTrials * 9 / 10);
  std::printf("placed %d of %d, NEES offset %.2f angle %.2f\n", placed, kTrials, offset_nees / placed,
              angle_nees / placed);
  // A consistent estimate has 1. The SDs are true to 15 %; the mean of so many squares varies by a quarter of
  // the tolerance.
  EXPECT_NEAR(offset_nees / placed, 1, 0.3);
  EXPECT_NEAR(angle_nees / placed, 1, 0.3);
}

TEST(Localise, DoesNotMoveASegmentWithoutAnEdge) {
  std::vector<std::uint8_t> pixels(64 * 64, 100);
  Segment s;
  s.a = {10, 30};
  s.b = {50, 33};
  const Segment before = s;
  EXPECT_FALSE(lsd::localise({pixels.data(), 64, 64, 64}, 0.5, s));
  EXPECT_EQ(s.a, before.a);
  EXPECT_EQ(s.b, before.b);
  EXPECT_EQ(s.sigma_px, 0.5);
  // The segment does not move onto an edge of the opposite sign either.
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = i < 64 * 32 ? 200 : 50;
  EXPECT_FALSE(lsd::localise({pixels.data(), 64, 64, 64}, 0.5, s));
  // Segments outside the image and segments without length are safe.
  s.a = {-40, -40};
  s.b = {-20, 90};
  EXPECT_FALSE(lsd::localise({pixels.data(), 64, 64, 64}, 0.5, s));
  s.b = s.a;
  EXPECT_FALSE(lsd::localise({pixels.data(), 64, 64, 64}, 0.5, s));
}

}  // namespace
}  // namespace plvo
