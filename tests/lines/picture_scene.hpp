// SPDX-License-Identifier: Apache-2.0
// A flat world of overlapping textured rectangles, rendered through any homography. The borders of the
// rectangles are known segments.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <vector>

#include "line_scene.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/lines/segment.hpp"
#include "plvo/math/types.hpp"

namespace plvo::test {

struct ScenePicture {
  int width = 320, height = 240;
  std::vector<std::uint8_t> pixels;
  GrayView view() const { return {pixels.data(), width, height, width}; }
};

class PictureScene {
 public:
  explicit PictureScene(std::uint64_t seed, int rectangles = 16) {
    Random random(seed);
    for (int i = 0; i < rectangles; ++i) {
      Rectangle r;
      r.centre = {320 * random.uniform(), 240 * random.uniform()};
      const double angle = 3.14159 * random.uniform();
      r.u = {std::cos(angle), std::sin(angle)};
      r.half = {15 + 40 * random.uniform(), 15 + 40 * random.uniform()};
      r.grey = 40 + 170 * random.uniform();
      r.stripe_wave = 0.2 + 0.6 * random.uniform();
      r.stripe_grey = 15 * random.uniform();
      rectangles_.push_back(r);
    }
  }

  // The grey level at a point of the world: that of the last rectangle that contains it.
  double grey(const Vector2& p) const {
    for (auto r = rectangles_.rbegin(); r != rectangles_.rend(); ++r) {
      const double dx = p.x() - r->centre.x(), dy = p.y() - r->centre.y();
      const double a = dx * r->u.x() + dy * r->u.y(), b = dy * r->u.x() - dx * r->u.y();
      if (std::abs(a) < r->half.x() && std::abs(b) < r->half.y())
        return r->grey +
               r->stripe_grey * std::sin(r->stripe_wave * a) * std::sin(0.7 * r->stripe_wave * b + 1);
    }
    return 110 + 10 * std::sin(0.11 * p.x()) + 10 * std::sin(0.13 * p.y() + 0.05 * p.x());
  }

  // H_world_picture maps homogeneous pixels to the world. `light` maps a grey level at a pixel to a grey
  // level. Each pixel has 2×2 samples.
  template <typename Light>
  ScenePicture render(const Matrix3& H_world_picture, const Light& light, double noise = 0,
                      std::uint64_t seed = 1) const {
    ScenePicture picture;
    Random random(seed);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        double sum = 0;
        for (const double j : {-0.25, 0.25})
          for (const double i : {-0.25, 0.25}) sum += 0.25 * grey(apply(H_world_picture, {x + i, y + j}));
        const double lit = light(sum, x, y) + (noise > 0 ? noise * gaussian(random) : 0);
        picture.pixels.push_back(static_cast<std::uint8_t>(std::fmin(255, std::fmax(0, lit + 0.5))));
      }
    return picture;
  }

  static Vector2 apply(const Matrix3& H, const Vector2& p) {
    const Vector3 q = H * Vector3(p.x(), p.y(), 1);
    return {q.x() / q.z(), q.y() / q.z()};
  }

  // The visible borders with contrast, in pixels, with the brighter side on the right. Entry k is the same
  // border in every image; its length is 0 where the border is not clearly visible.
  std::vector<Segment> borders(const Matrix3& H_world_picture) const {
    const Matrix3 H_picture_world = Eigen::Matrix3d(H_world_picture).inverse();
    std::vector<Segment> result;
    for (const Rectangle& r : rectangles_) {
      const Vector2 v(-r.u.y(), r.u.x());
      const Vector2 corner[4] = {
          r.centre - r.half.x() * r.u - r.half.y() * v, r.centre + r.half.x() * r.u - r.half.y() * v,
          r.centre + r.half.x() * r.u + r.half.y() * v, r.centre - r.half.x() * r.u + r.half.y() * v};
      for (int k = 0; k < 4; ++k) {
        const Vector2 a = corner[k], b = corner[(k + 1) % 4];
        const Vector2 direction = (b - a).normalized(), inwards(-direction.y(), direction.x());
        // The least contrast along the border in the world, with its sign.
        double least = 1e9, sign = 0;
        for (int i = 1; i < 20; ++i) {
          const Vector2 p = a + i / 20.0 * (b - a);
          const double step = grey(p + 2 * inwards) - grey(p - 2 * inwards);
          if (i == 1) sign = step > 0 ? 1 : -1;
          least = std::fmin(least, sign * step);
        }
        Segment s;
        s.a = apply(H_picture_world, sign > 0 ? a : b);
        s.b = apply(H_picture_world, sign > 0 ? b : a);
        const auto seen = [](const Vector2& p) {
          return p.x() > 4 && p.y() > 4 && p.x() < 315 && p.y() < 235;
        };
        if (least < 12 || !seen(s.a) || !seen(s.b)) s = Segment{};
        result.push_back(s);
      }
    }
    return result;
  }

 private:
  struct Rectangle {
    Vector2 centre, u, half;
    double grey, stripe_wave, stripe_grey;
  };
  std::vector<Rectangle> rectangles_;
};

inline double as_it_is(double grey, int, int) { return grey; }

}  // namespace plvo::test
