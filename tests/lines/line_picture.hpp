// SPDX-License-Identifier: Apache-2.0
// Images with known segments: convex polygons, anti-aliased by supersampling, with noise and the pyramid of
// the library; and a detector with its memory.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/lines/lsd/lsd.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::test {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<double> light;  // grey levels, before noise and rounding

  Picture(int w, int h, double level) : width(w), height(h) {
    light.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), level);
  }
  double& at(int x, int y) {
    return light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

// The corners are clockwise as seen on the image. Pixels on the outline have 8 × 8 samples.
inline void fill_polygon(Picture& picture, const std::vector<Vector2>& corners, double level) {
  const auto depth_inside = [&](double x, double y) {  // > 0 inside, px
    double depth = 1e9;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2 a = corners[i];
      const Vector2 d = (corners[(i + 1) % corners.size()] - a).normalized();
      depth = std::min(depth, d.x() * (y - a.y()) - d.y() * (x - a.x()));
    }
    return depth;
  };
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double depth = depth_inside(x, y);
      if (depth < -1) continue;
      int inside = 64;
      if (depth < 1) {
        inside = 0;
        for (int k = 0; k < 64; ++k) {
          inside += depth_inside(x + (k % 8 - 3.5) / 8, y + (k / 8 - 3.5) / 8) >= 0 ? 1 : 0;
        }
      }
      picture.at(x, y) += (level - picture.at(x, y)) * inside / 64.0;
    }
  }
}

// A regular polygon rotated by `angle`; `radius` is that of its corners.
inline std::vector<Vector2> regular_polygon(const Vector2& centre, int sides, double radius, double angle) {
  std::vector<Vector2> corners;
  for (int i = 0; i < sides; ++i) {
    const double turn = angle + 2 * kPi * i / sides;
    corners.push_back(centre + radius * Vector2(std::cos(turn), std::sin(turn)));
  }
  return corners;
}

inline double gaussian_noise(Random& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum - 6;
}

inline std::vector<std::uint8_t> expose(const Picture& picture, double noise_sd, Random& random) {
  std::vector<std::uint8_t> pixels;
  for (const double level : picture.light) {
    const double value = level + (noise_sd > 0 ? noise_sd * gaussian_noise(random) : 0);
    pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)));
  }
  return pixels;
}

// The detector as the library uses it: detection on the half-resolution level, localisation on the full
// image.
class DetectorRig {
 public:
  DetectorRig(int width, int height, std::size_t capacity = 256)
      : DetectorRig(width, height, capacity, {(width + 1) / 2, (height + 1) / 2}) {}
  DetectorRig(int width, int height, std::size_t capacity, const SegmentSearch& search)
      : detector_(search),
        memory_(pyramid_bytes(width, height) + SegmentDetector::scratch_bytes(search) + kArenaAlignment),
        arena_(memory_),
        storage_(capacity),
        segments_(storage_) {
    pyramid_.allocate(arena_, width, height);
    pyramid_.init(width, height);
  }

  const FixedVector<Segment>& detect(const std::vector<std::uint8_t>& pixels) {
    std::copy(pixels.begin(), pixels.end(), pyramid_.base().data);
    pyramid_.build();
    const std::size_t before = arena_.used();
    const Status status =
        detector_.detect(pyramid_.level(1), 2.0, pyramid_.level(0), arena_, segments_, &counts_);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(arena_.used(), before);
    return segments_;
  }
  const SegmentCounts& counts() const { return counts_; }

 private:
  static std::size_t pyramid_bytes(int width, int height) {
    Arena sizer = Arena::counting();
    Pyramid pyramid;
    pyramid.allocate(sizer, width, height);
    return sizer.peak();
  }
  Pyramid pyramid_;
  SegmentDetector detector_;
  std::vector<std::byte> memory_;
  Arena arena_;
  std::vector<Segment> storage_;
  FixedVector<Segment> segments_;
  SegmentCounts counts_;
};

}  // namespace plvo::test
