// SPDX-License-Identifier: Apache-2.0
// Box P1 of the paper, with plvo's own detector in place of SURF. Every pyramid level is divided into square
// cells. In each cell, the segment test proposes pixels. Its threshold starts at a share of the cell's
// contrast and falls until the cell has enough pixels or the noise floor is reached. When the illumination
// dims, the threshold scales with the image, and the same corners remain. The smaller eigenvalue of the
// structure tensor (Shi & Tomasi, "Good features to track", CVPR 1994) ranks the proposals; it also
// determines how accurately a corner can be localised.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/points/carried_cells.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// The odometry uses these defaults; only tests of the detector change them.
struct DetectorConfig {
  int levels = 3;  // number of searched pyramid levels, 1 … Pyramid::kMaxLevels
  int cell_px =
      40;  // side of the cells on each level, over which the keypoints are spread; kMinCell … kMaxCell
  int noise_floor = 5;      // grey levels; smaller contrast is sensor noise, 1 … 64
  double min_strength = 8;  // smallest Keypoint::strength
};

inline constexpr int kMinCell = 24;  // px, limits of DetectorConfig::cell_px
inline constexpr int kMaxCell = 64;

// Margin in pixels of each level. Descriptor and patch must fit into the image.
inline constexpr int kKeypointMargin = 17;
// Largest number of keypoints considered per cell.
inline constexpr int kKeypointsPerCell = 16;

// A corner that may become a keypoint.
struct DetectionCandidate {
  float strength;
  std::int16_t x, y;
  std::uint8_t level;
  std::uint8_t rank;  // rank within its cell
};
// Number of cells of one level.
constexpr std::size_t detection_cells(int width, int height, int cell_px) {
  const int columns = (width - 2 * kKeypointMargin + cell_px - 1) / cell_px;
  const int rows = (height - 2 * kKeypointMargin + cell_px - 1) / cell_px;
  return columns <= 0 || rows <= 0 ? 0 : static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

// Bytes for the scores of a row of cells and a rim of one pixel, which the non-maximum suppression reads.
// Rows are padded to whole vectors.
constexpr std::size_t detection_band(int width, int cell_px) {
  return static_cast<std::size_t>((width + 15) / 16 * 16) * static_cast<std::size_t>(cell_px + 2);
}

// Reserves the scratch of detect_keypoints, for the smallest cells and all levels.
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
  int candidates = 0;  // number of local maxima, before the selection
};

// Smaller eigenvalue of the mean 2×2 structure tensor over the 7×7 window around pixel (x, y).
double corner_strength(GrayView image, int x, int y);

// Fills `out` up to its capacity: first the best keypoint of every cell, then the second best, and so on. Of
// a rank that does not fit completely, the strongest are kept. Pixels without depth (DepthSampler::near) are
// skipped, because only 3D points are of use; so are those whose patch reaches into the mask, and those in
// carried cells. out.dropped() counts the candidates that did not fit. Scratch: see reserve_detection.
DetectionSummary detect_keypoints(const Pyramid& pyramid, const DepthSampler& depth,
                                  const DetectorConfig& config, Arena& scratch, FixedVector<Keypoint>& out,
                                  const ImageMask& mask = {}, const CarriedCells& carried = {});

}  // namespace plvo
