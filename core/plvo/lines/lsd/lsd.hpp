// SPDX-License-Identifier: Apache-2.0
// L1 of the paper: line segments, after Grompone von Gioi et al., "LSD: a fast line segment detector with a
// false detection control" (PAMI 2010), written from the published description. Segments are found on a
// reduced level of the image pyramid (half resolution serves VGA) and then placed on the full-resolution
// image. No threshold on contrast decides what a segment is, the number of false alarms does.
//
// Time is bounded: each pixel is given back at most kMaxReleases = 5 times, so it is added to a region at
// most six times, and each time the blocks around it are looked at; every other pass over a region or its
// rectangle costs at most a constant times the region's size, and at most as many segments are placed as the
// caller has room for.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/status.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/lines/lsd/line_validation.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

// What one detection did: for the bookkeeping of a frame and the tests of its bounds.
struct SegmentCounts {
  std::int32_t directed_pixels = 0;  // whose gradient is above the quantisation noise
  std::int32_t regions = 0;          // grown to at least the smallest size that can be meaningful
  std::int32_t dense = 0;            // of these, long and full enough to be tested
  std::int32_t meaningful = 0;       // of these, with NFA ≤ 1
  std::int32_t placed = 0;           // of those kept, moved onto the full-resolution edge
  std::int64_t grown_pixels = 0;     // pixels added to regions, repeats included
};

struct SegmentSearch {
  int width = 1, height = 1;  // of the image that is searched (the reduced one)
  // Bands of rows that are searched one after the other, each in the memory of the one before: regions end at
  // their borders.
  int bands = 1;
  // What is found beyond this is dropped. Strong gradients are looked at first.
  std::size_t most_candidates = std::numeric_limits<std::size_t>::max();
};

class SegmentDetector {
 public:
  explicit SegmentDetector(const SegmentSearch& search)
      : search_(search), false_alarms_(search.width, search.height) {}
  SegmentDetector(int width, int height) : SegmentDetector(SegmentSearch{width, height}) {}
  SegmentDetector() : SegmentDetector(SegmentSearch{}) {}

  // The most memory that detect takes for a moment from its scratch.
  static constexpr std::size_t scratch_bytes(const SegmentSearch& search);
  static constexpr std::size_t scratch_bytes(int width, int height) {
    return scratch_bytes(SegmentSearch{width, height});
  }

  // reduced: 8-bit, smoothed against aliasing; its pixel (x, y) lies at (scale x, scale y) of full. out:
  // cleared, then filled with the segments, most meaningful first. Where more are found than fit, half of the
  // room goes to the most meaningful; the other half goes round a 6 × 4 grid of cells, the best of every cell
  // (by its middle) before the second of any; the rest is counted in out.dropped(). Fails on images of
  // another size than announced or wider than LevelLineField::kMostWidth, on an image that is not there, and
  // when scratch is too small.
  Status detect(GrayView reduced, double scale, GrayView full, Arena& scratch, FixedVector<Segment>& out,
                SegmentCounts* counts = nullptr) const;

 private:
  // A meaningful rectangle, in pixels of the reduced image.
  struct Candidate {
    Vector2 a, b;
    double meaningfulness = 0;
    std::int32_t order = 0;  // in which it was found
    std::int32_t rank = 0;   // within its cell
  };
  struct Scratch {
    lsd::LevelLineField field;
    std::span<lsd::Run> region;
    std::span<Candidate> candidates;
  };

  // A smaller region is not meaningful even when all of it is aligned: 8^n < (width · height)^(5/2), in
  // powers of two rounded down.
  static constexpr std::size_t min_region(int width, int height) {
    const std::size_t log2_area = std::bit_width(scratch_pixels(width, height));
    return log2_area > 2 ? (5 * (log2_area - 1) / 2 + 2) / 3 : 2;
  }

  // Rows of the field in a band; the last one may have fewer.
  static constexpr int band_rows(const SegmentSearch& search) {
    return search.height > 1 ? (search.height - 1 + search.bands - 1) / search.bands : 0;
  }

  static constexpr Scratch allocate(Arena& memory, const SegmentSearch& search) {
    Scratch scratch;
    const int band_height = band_rows(search) + 1;
    scratch.field = lsd::allocate_field(memory, search.width, band_height);
    scratch.region = memory.take<lsd::Run>("lines/lsd", scratch_pixels(search.width, band_height) + 1);
    // No two meaningful regions share a pixel: that bounds their number.
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

  // Of the band whose first row is the image's row row_0. Adds to the counts, and to the candidates as long
  // as there is room.
  void search(GrayView band, int row_0, Scratch& scratch, SegmentCounts& counts) const;
  static Candidate describe(const lsd::Rectangle& rectangle, int row_0, double meaningfulness);
  // Brings those to be kept to the front and returns their number.
  std::size_t select(std::span<Candidate> candidates, std::size_t capacity) const;

  SegmentSearch search_;
  lsd::FalseAlarms false_alarms_;
};

// Behind the class: Clang evaluates at compile time only what it has seen the whole of.
constexpr std::size_t SegmentDetector::scratch_bytes(const SegmentSearch& search) {
  Arena sizer = Arena::counting();
  allocate(sizer, search);
  return sizer.peak();
}

}  // namespace plvo
