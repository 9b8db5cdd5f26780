// SPDX-License-Identifier: Apache-2.0
// L1 of the paper: line segments, after Grompone von Gioi et al., "LSD: a fast line segment detector with a
// false detection control" (PAMI 2010), written from the published description. Segments are detected on a
// reduced level of the image pyramid (half resolution suits VGA) and then localised in the full-resolution
// image. The number of false alarms decides what a segment is; there is no contrast threshold.
//
// Time is bounded. Each pixel is released at most kMaxReleases = 5 times, so it is added to a region at most
// six times, and each time the blocks around it are examined. Every other pass over a region or its rectangle
// costs at most a constant times the region's size. The number of localised segments is at most the capacity
// of the output.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/status.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/lines/lsd/line_validation.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

// Counts of one detection. The tests of the bounds read the pixels.
struct SegmentCounts {
  std::int32_t directed_pixels = 0;  // pixels whose gradient exceeds the quantisation noise
  std::int32_t meaningful = 0;       // regions with NFA ≤ 1
  std::int64_t grown_pixels = 0;     // pixels added to regions, including repeats
};

struct SegmentSearch {
  int width = 1, height = 1;  // size of the searched image (the reduced one)
  // Number of bands of rows. They are searched one after another in the same memory; regions end at their
  // borders.
  int bands = 1;
  // Limit of candidates; further ones are dropped. Strong gradients are processed first.
  std::size_t most_candidates = std::numeric_limits<std::size_t>::max();
};

class SegmentDetector {
 public:
  explicit SegmentDetector(const SegmentSearch& search)
      : search_(search), false_alarms_(search.width, search.height) {}
  SegmentDetector(int width, int height) : SegmentDetector(SegmentSearch{width, height}) {}
  SegmentDetector() : SegmentDetector(SegmentSearch{}) {}

  // Largest amount of scratch memory that detect takes.
  static constexpr std::size_t scratch_bytes(const SegmentSearch& search);
  static constexpr std::size_t scratch_bytes(int width, int height) {
    return scratch_bytes(SegmentSearch{width, height});
  }

  // reduced: 8-bit, smoothed against aliasing. Its pixel (x, y) lies at (scale x, scale y) of full. out:
  // cleared, then filled with the segments, most meaningful first. If there are more than fit, half of the
  // capacity goes to the most meaningful ones. The other half is spread over a 6 × 4 grid of cells: the best
  // of every cell (by its middle) before the second best of any. out.dropped() counts the rest. Fails if an
  // image is missing, has another size than announced, or is wider than LevelLineField::kMostWidth, and if
  // scratch is too small. mask: of full; segments keep away from it.
  Status detect(GrayView reduced, double scale, GrayView full, Arena& scratch, FixedVector<Segment>& out,
                SegmentCounts* counts = nullptr, const ImageMask& mask = {}) const;

 private:
  // A meaningful rectangle, in pixels of the reduced image.
  struct Candidate {
    Vector2 a, b;
    double meaningfulness = 0;
    std::int32_t order = 0;  // order of detection
    std::int32_t rank = 0;   // rank within its cell
  };
  struct Scratch {
    lsd::LevelLineField field;
    std::span<lsd::PixelRun> region;
    std::span<Candidate> candidates;
  };

  // Smallest number of pixels of a meaningful region. A smaller one is not meaningful even if all its pixels
  // are aligned: 8^n < (width · height)^(5/2), in powers of two rounded down.
  static constexpr std::size_t min_region(int width, int height) {
    const std::size_t log2_area = std::bit_width(scratch_pixels(width, height));
    return log2_area > 2 ? (5 * (log2_area - 1) / 2 + 2) / 3 : 2;
  }

  // Rows of the field in a band. The last band may have fewer.
  static constexpr int band_rows(const SegmentSearch& search) {
    return search.height > 1 ? (search.height - 1 + search.bands - 1) / search.bands : 0;
  }

  static constexpr Scratch allocate(Arena& memory, const SegmentSearch& search) {
    Scratch scratch;
    const int band_height = band_rows(search) + 1;
    scratch.field = lsd::allocate_field(memory, search.width, band_height);
    scratch.region = memory.take<lsd::PixelRun>("lines/lsd", scratch_pixels(search.width, band_height) + 1);
    // Meaningful regions are disjoint, which bounds their number.
    const std::size_t bound =
        scratch_pixels(search.width, search.height) / min_region(search.width, search.height) + 1;
    scratch.candidates =
        memory.take<Candidate>("lines/lsd", bound < search.most_candidates ? bound : search.most_candidates);
    return scratch;
  }
  static constexpr std::size_t scratch_pixels(int width, int height) {
    return width > 1 && height > 1
               ? static_cast<std::size_t>(width - 1) * static_cast<std::size_t>(height - 1)
               : 0;
  }

  // Searches the band whose first row is the image's row row_0. Adds to the counts, and to the candidates up
  // to their capacity.
  void search(GrayView band, const lsd::FieldMask& masked, Scratch& scratch, SegmentCounts& counts) const;
  static Candidate describe(const lsd::Rectangle& rectangle, int row_0, double meaningfulness);
  // Moves the selected candidates to the front and returns their number.
  std::size_t select(std::span<Candidate> candidates, std::size_t capacity) const;

  SegmentSearch search_;
  lsd::FalseAlarms false_alarms_;
};

// Defined after the class, because Clang evaluates at compile time only what it has parsed completely.
constexpr std::size_t SegmentDetector::scratch_bytes(const SegmentSearch& search) {
  Arena sizer = Arena::counting();
  allocate(sizer, search);
  return sizer.peak();
}

}  // namespace plvo
