// SPDX-License-Identifier: Apache-2.0
// Draws the features of the odometry: keypoints, segments and matches over the undistorted image; and depth
// in colours.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::report {

// Kind of a segment; the report and the overlays use the same colours.
enum class FeatureKind : std::uint8_t {
  kPlain,    // as detected, without 3D
  kWith3d,   // lifted to 3D, unmatched
  kOutlier,  // matched, but inconsistent with the motion
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

// Draws over the dimmed undistorted image in the colours of palette.hpp; a matched point has a stroke to its
// position in the reference.
Picture draw_overlay(const FeatureView& features);

// Uses the colours of palette.hpp, black without depth; half the size in each direction.
Picture draw_depth(const DepthView& depth);

}  // namespace plvo::report
