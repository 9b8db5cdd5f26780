// SPDX-License-Identifier: Apache-2.0
// Box P1 of the paper, with our own detector in place of SURF. Every level of the pyramid is cut into square
// cells. In a cell the segment test proposes pixels, with a threshold that starts at a share of that cell's
// own contrast and falls until the cell has enough or the noise floor is reached: a lamp that dims scales the
// image, the threshold with it, and the same corners stay. The smaller eigenvalue of the structure tensor
// (Shi & Tomasi, "Good features to track", CVPR 1994) ranks them; it is also what decides how well a corner
// can be localised.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

struct DetectorConfig {
  int levels = 3;       // of the pyramid that are searched, 1 … Pyramid::kMaxLevels
  int cell_px = 40;     // keypoints are spread over cells of this side on each level; kMinCell … kMaxCell
  int noise_floor = 5;  // grey levels: contrast below this is the sensor's noise, 1 … 64
  double min_strength = 8;  // of Keypoint::strength
};

inline constexpr int kMinCell = 24;  // px, bounds of DetectorConfig::cell_px
inline constexpr int kMaxCell = 64;

// Pixels from the border of a level that stay free: descriptor and patch must fit.
inline constexpr int kKeypointMargin = 17;
// At most so many keypoints of one cell are considered at all.
inline constexpr int kKeypointsPerCell = 16;

// A corner that competes for a place.
struct DetectionCandidate {
  float strength;
  std::int16_t x, y;
  std::uint8_t level;
  std::uint8_t rank;  // among its cell's
};
// Cells of one level.
constexpr std::size_t detection_cells(int width, int height, int cell_px) {
  const int columns = (width - 2 * kKeypointMargin + cell_px - 1) / cell_px;
  const int rows = (height - 2 * kKeypointMargin + cell_px - 1) / cell_px;
  return columns <= 0 || rows <= 0 ? 0 : static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

// The segment test's scores of a row of cells, with a rim of one pixel, which the non-maximum suppression
// looks at; whole vectors of them.
constexpr std::size_t detection_band(int width, int cell_px) {
  return static_cast<std::size_t>((width + 15) / 16 * 16) * static_cast<std::size_t>(cell_px + 2);
}

// What detect_keypoints takes of the scratch, for the smallest cells and all levels.
constexpr void reserve_detection(Arena& memory, int width, int height) {
  const ScratchScope scope(memory);
  memory.take<std::uint8_t>("keypoint scores", detection_band(width, kMaxCell));
  std::size_t cells = 0;
  for (int level = 0; level < Pyramid::kMaxLevels; ++level) {
    cells += detection_cells(width, height, kMinCell);
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  memory.take<DetectionCandidate>("keypoint candidates", cells * kKeypointsPerCell);
}

struct DetectionSummary {
  int candidates = 0;  // local maxima found, before the selection
};

// Smaller eigenvalue of the mean 2×2 structure tensor over the 7×7 window around pixel (x, y).
double corner_strength(GrayView image, int x, int y);

// Fills `out` with at most its capacity: all cells' best, then all cells' second best, and so on; where a
// rank does not fit whole, its strongest. Pixels without depth are passed over, since only 3D points serve.
// What was a local maximum but did not fit is counted by out.dropped(). Scratch: see reserve_detection.
DetectionSummary detect_keypoints(const Pyramid& pyramid, const DepthSampler& depth,
                                  const DetectorConfig& config, Arena& scratch, FixedVector<Keypoint>& out);

}  // namespace plvo
