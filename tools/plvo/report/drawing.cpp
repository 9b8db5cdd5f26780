// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/drawing.hpp"

#include <algorithm>
#include <cmath>

#include "plvo/report/palette.hpp"

namespace plvo::report {
namespace {

// Keep widths and dimming equal to those of the page (page/frames.js).
constexpr double kDimming = 0.7;  // factor for the image; the drawing stands out

struct Pen {
  Colour colour;
  double width_px;
};

Pen segment_pen(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::kPlain: return {kSeenColour, 1.2};
    case FeatureKind::kWith3d: return {kLine3dColour, 1.6};
    case FeatureKind::kOutlier: return {kRejectedColour, 2};
    case FeatureKind::kInlier: break;
  }
  return {kLineColour, 3};
}

std::uint8_t* pixel_at(Picture& picture, int x, int y) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return nullptr;
  return picture.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                   static_cast<std::size_t>(x));
}

void blend(Picture& picture, int x, int y, Colour colour, double share) {
  std::uint8_t* p = pixel_at(picture, x, y);
  if (p == nullptr || share <= 0) return;
  const auto mix = [share](std::uint8_t old, std::uint8_t fresh) {
    return static_cast<std::uint8_t>(std::lround(old + std::min(share, 1.0) * (fresh - old)));
  };
  p[0] = mix(p[0], colour.r);
  p[1] = mix(p[1], colour.g);
  p[2] = mix(p[2], colour.b);
}

// Draws a stroke with round ends. The coverage of a pixel is half the width minus its distance from the axis.
// The loop runs along the longer direction and, across it, as far as the stroke reaches.
void draw_stroke(Picture& picture, double x0, double y0, double x1, double y1, Pen pen) {
  const double dx = x1 - x0;
  const double dy = y1 - y0;
  const double squared = dx * dx + dy * dy;
  // A feature lies at most slightly outside the image; do not draw longer strokes.
  if (!(squared < 4096.0 * 4096.0)) return;
  const bool steep = std::abs(dy) > std::abs(dx);
  const double reach = 0.5 * pen.width_px + 1;
  const double from = steep ? std::min(y0, y1) : std::min(x0, x1);
  const double to = steep ? std::max(y0, y1) : std::max(x0, x1);
  const double slope = squared > 0 ? (steep ? dx / dy : dy / dx) : 0;
  for (int along = static_cast<int>(std::floor(from - reach)); along <= to + reach; ++along) {
    const double axis = steep ? x0 + slope * (along - y0) : y0 + slope * (along - x0);
    const int across_end = static_cast<int>(std::ceil(axis + 1.5 * reach));
    for (int across = static_cast<int>(std::floor(axis - 1.5 * reach)); across <= across_end; ++across) {
      const int x = steep ? across : along;
      const int y = steep ? along : across;
      const double f = squared > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / squared, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(x - x0 - f * dx, y - y0 - f * dy);
      blend(picture, x, y, pen.colour, 0.5 * pen.width_px + 0.5 - distance);
    }
  }
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
    for (int x = 0; x < f.image.width; ++x)
      picture.rgb.insert(picture.rgb.end(), 3, static_cast<std::uint8_t>(kDimming * f.image.at(x, y) + 0.5));
  for (const Keypoint& k : f.keypoints) draw_stroke(picture, k.u, k.v, k.u, k.v, {kSeenColour, 2.5});
  const std::vector<SegmentFate> lines = segment_fates(f);
  for (const bool matched : {false, true}) {  // matched segments lie on top
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const SegmentView& s = f.segments[i];
      if ((lines[i].reference >= 0) == matched)
        draw_stroke(picture, s.a_u, s.a_v, s.b_u, s.b_v, segment_pen(lines[i].kind));
    }
  }
  for (const PointTrackView& t : f.point_tracks) {
    const Colour colour = t.inlier ? kPointColour : kRejectedColour;
    draw_stroke(picture, t.u, t.v, t.u_reference, t.v_reference, {colour, 1.2});
    draw_stroke(picture, t.u, t.v, t.u, t.v, {colour, 3.5});
  }
  return picture;
}

Picture draw_depth(const DepthView& depth) {
  Picture picture{depth.width / 2, depth.height / 2, {}};
  picture.rgb.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) * 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double d = depth.data[2 * y * depth.stride + 2 * x] * depth.metres_per_unit;
      if (d <= 0) continue;
      blend(picture, x, y, depth_colour(d), 1);
    }
  }
  return picture;
}

}  // namespace plvo::report
