// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace plvo::report {
namespace {

struct Colour {
  std::uint8_t r, g, b;
};

constexpr std::array<Colour, 4> kKindColours = {
    {{154, 163, 173}, {255, 210, 63}, {255, 90, 54}, {61, 220, 109}}};

Colour colour_of(FeatureKind kind) { return kKindColours[static_cast<std::size_t>(kind)]; }

void set_pixel(Picture& picture, int x, int y, Colour colour) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  std::uint8_t* p =
      picture.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                static_cast<std::size_t>(x));
  p[0] = colour.r;
  p[1] = colour.g;
  p[2] = colour.b;
}

void draw_line(Picture& picture, double x0, double y0, double x1, double y1, Colour colour) {
  // A feature may lie a little outside the image, never far: longer strokes are not worth drawing.
  const double length = std::max(std::abs(x1 - x0), std::abs(y1 - y0));
  if (!(length < 4096)) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(length)));
  for (int i = 0; i <= steps; ++i) {
    const double f = static_cast<double>(i) / steps;
    set_pixel(picture, static_cast<int>(std::lround(x0 + f * (x1 - x0))),
              static_cast<int>(std::lround(y0 + f * (y1 - y0))), colour);
  }
}

void draw_circle(Picture& picture, double x, double y, double radius, Colour colour) {
  const int steps = std::max(12, static_cast<int>(7 * radius));
  for (int i = 0; i < steps; ++i) {
    const double angle = 6.283185307179586 * i / steps;
    set_pixel(picture, static_cast<int>(std::lround(x + radius * std::cos(angle))),
              static_cast<int>(std::lround(y + radius * std::sin(angle))), colour);
  }
}

// Red over yellow, green and cyan to blue, as `value` goes from 0 to 1.
Colour rainbow(double value) {
  const double h = 4 * std::clamp(value, 0.0, 1.0);
  const auto level = [](double v) { return static_cast<std::uint8_t>(255 * std::clamp(v, 0.0, 1.0)); };
  return {level(2 - h), level(h < 2 ? h : 4 - h), level(h - 2)};
}

}  // namespace

std::vector<SegmentFate> segment_fates(const FeatureView& f) {
  std::vector<SegmentFate> fates(f.segments.size());
  for (std::size_t i = 0; i < fates.size(); ++i)
    fates[i].kind = f.segments[i].has_3d ? FeatureKind::kWith3d : FeatureKind::kPlain;
  for (const LineTrackView& track : f.line_tracks) {
    if (track.current >= f.segments.size() || track.reference >= f.reference_segments.size()) continue;
    fates[track.current] = {track.inlier ? FeatureKind::kInlier : FeatureKind::kOutlier, track.reference};
  }
  return fates;
}

Picture draw_overlay(const FeatureView& f) {
  Picture picture{f.image.width, f.image.height, {}};
  for (int y = 0; y < f.image.height; ++y)
    for (int x = 0; x < f.image.width; ++x) picture.rgb.insert(picture.rgb.end(), 3, f.image.at(x, y));
  const std::vector<SegmentFate> lines = segment_fates(f);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const SegmentView& s = f.segments[i];
    const Colour colour = colour_of(lines[i].kind);
    draw_line(picture, s.a_u, s.a_v, s.b_u, s.b_v, colour);
    draw_line(picture, s.a_u + 1, s.a_v, s.b_u + 1, s.b_v, colour);
  }
  for (const Keypoint& k : f.keypoints)
    draw_circle(picture, k.u, k.v, 2.5 * (1 << k.level), colour_of(FeatureKind::kPlain));
  for (const PointTrackView& t : f.point_tracks) {
    const Colour colour = colour_of(t.inlier ? FeatureKind::kInlier : FeatureKind::kOutlier);
    draw_circle(picture, t.u, t.v, 2, colour);
    draw_line(picture, t.u, t.v, t.u_reference, t.v_reference, colour);
  }
  return picture;
}

Picture draw_depth(const DepthView& depth, double near_m, double far_m) {
  Picture picture{depth.width / 2, depth.height / 2, {}};
  picture.rgb.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double d = depth.data[2 * y * depth.stride + 2 * x] * depth.metres_per_unit;
      if (d > 0) set_pixel(picture, x, y, rainbow((d - near_m) / (far_m - near_m)));
    }
  }
  return picture;
}

}  // namespace plvo::report
