// SPDX-License-Identifier: Apache-2.0
// Pictures of what the odometry saw: keypoints, segments and matches over the undistorted image, and
// depth in colours.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::report {

// What became of a segment; the report and the overlays use one set of colours.
enum class FeatureKind : std::uint8_t {
  kPlain,    // as detected, without 3D
  kWith3d,   // lifted to 3D, unmatched
  kOutlier,  // matched, but against the motion
  kInlier,
};

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  ColourView view() const {
    return {rgb.data(), width, height, width * std::ptrdiff_t{3}, PixelFormat::kRgb8};
  }
};

// One entry per segment of the current frame; `reference` is −1 without a match.
struct SegmentFate {
  FeatureKind kind = FeatureKind::kPlain;
  int reference = -1;
};
std::vector<SegmentFate> segment_fates(const FeatureView& features);

// The undistorted image, dimmed. Points: grey dots as detected; green where followed, with a stroke to where
// they were in the reference; red where rejected. Segments: grey; blue with 3D; orange where matched; red
// where the match was rejected.
Picture draw_overlay(const FeatureView& features);

// In the colours of depth_palette.hpp, black where there is none; at half the size in each direction.
Picture draw_depth(const DepthView& depth);

}  // namespace plvo::report
