// SPDX-License-Identifier: Apache-2.0
// The matches around a match. Neighbouring features mostly lie on one object and move together. An
// inlier among outliers therefore mostly belongs to an object that moves by itself. It agrees with
// the camera's motion by chance: a line, for example, if the object moves along it. A few such
// inliers near the camera can outweigh the room.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "plvo/motion/image_cells.hpp"

namespace plvo {

// First count all usable matches, then ask for each inlier. Takes 2.3 kB.
class Neighbourhoods {
 public:
  Neighbourhoods() { counts_.fill({}); }
  void count(std::size_t cell, bool is_inlier) {
    Counts& counts = counts_[index_of(cell)];
    std::uint8_t& matches = is_inlier ? counts.inliers : counts.outliers;
    if (matches < 255) ++matches;
    ++(is_inlier ? inliers_ : outliers_);
  }
  // Whether an inlier in this cell, which was counted, is isolated: its cell and the eight around it hold
  // kLeastOutliers or more, and more than kTimesTheInliers times as many as other inliers. Where outliers are
  // the majority of all matches, both numbers grow with outliers per inlier: wrong matches lie everywhere.
  bool is_isolated(std::size_t cell) const {
    int inliers = -1, outliers = 0;
    const Counts* row = &counts_[index_of(cell) - kStride - 1];
    for (int v = 0; v < 3; ++v, row += kStride)
      for (int u = 0; u < 3; ++u) {
        inliers += row[u].inliers;
        outliers += row[u].outliers;
      }
    const int majority = std::max(inliers_, outliers_);
    return outliers * inliers_ >= kLeastOutliers * majority &&
           outliers * inliers_ > kTimesTheInliers * inliers * majority;
  }

 private:
  struct Counts {
    std::uint8_t inliers = 0, outliers = 0;
  };

  // Single outliers are wrong matches. In a world at rest about an eighth of the matches are outliers, so
  // this many are seldom together.
  static constexpr int kLeastOutliers = 4;
  static constexpr int kTimesTheInliers = 2;

  // A border of empty cells surrounds the image.
  static constexpr std::size_t kStride = ImageCells::kSide + 2;
  static constexpr std::size_t index_of(std::size_t cell) {
    return (cell / ImageCells::kSide + 1) * kStride + cell % ImageCells::kSide + 1;
  }

  std::array<Counts, kStride * kStride> counts_;
  int inliers_ = 0, outliers_ = 0;
};

}  // namespace plvo
