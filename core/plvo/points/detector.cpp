// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/detector.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "plvo/base/bits.hpp"
#include "plvo/base/build.hpp"
#include "plvo/base/heap_sort.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/points/fast.hpp"

namespace plvo {
namespace {

using Candidate = DetectionCandidate;

struct Cell {
  int x0, y0, x1, y1;  // pixels of its level, half open
};

constexpr int kBytes = sizeof(Bytes);  // scores or grey levels in one vector

// All bits of byte i are set if column x + i belongs to the cell.
Bytes columns_of(const Cell& cell, int x) {
  constexpr Bytes kPlaces = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const auto columns = static_cast<std::uint8_t>(std::min(cell.x1 - x, kBytes));
  return kPlaces < columns ? ~Bytes{} : Bytes{};
}

// Initial threshold: an eighth of the range of grey levels in the cell, over every second pixel.
[[maybe_unused]] int contrast_threshold_each(GrayView image, const Cell& cell) {
  int low = 255;
  int high = 0;
  for (int y = cell.y0; y < cell.y1; y += 2) {
    const std::uint8_t* row = image.row(y);
    for (int x = cell.x0; x < cell.x1; x += 2) {
      low = std::min<int>(low, row[x]);
      high = std::max<int>(high, row[x]);
    }
  }
  return (high - low) / 8;
}

// The same, sixteen columns at once. Columns beyond the cell are still in the image, because of the keypoint
// margin.
int contrast_threshold(GrayView image, const Cell& cell) {
  if constexpr (kSimdLoops) return contrast_threshold_each(image, cell);
  static_assert(kKeypointMargin >= kBytes);
  constexpr Bytes kNever = {0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255};
  Bytes low = ~Bytes{}, high = {};
  for (int x = cell.x0; x < cell.x1; x += kBytes) {
    Bytes least = ~Bytes{}, most = {};
    for (int y = cell.y0; y < cell.y1; y += 2) {
      Bytes levels;
      std::memcpy(&levels, image.row(y) + x, sizeof levels);
      least = levels < least ? levels : least;
      most = levels > most ? levels : most;
    }
    const Bytes out = ~columns_of(cell, x) | kNever;
    least |= out;
    most &= ~out;
    low = least < low ? least : low;
    high = most > high ? most : high;
  }
  std::uint8_t lowest = 255;
  std::uint8_t highest = 0;
  for (int i = 0; i < kBytes; i += 2) {
    lowest = std::min<std::uint8_t>(lowest, low[i]);
    highest = std::max<std::uint8_t>(highest, high[i]);
  }
  return (highest - lowest) / 8;
}

// Sum of the bytes of a word. Each byte is at most 128.
template <typename Word>
Word sum_of_bytes(Word bytes) {
  constexpr Word kPairs = ~Word{0} / 0xffff;  // … 00010001: the lowest bit of every two bytes
  return ((bytes & 255 * kPairs) + (bytes >> 8 & 255 * kPairs)) * kPairs >> (8 * sizeof(Word) - 16);
}

// Scores of the segment test for one row of cells and a rim of one pixel around it. Scores up to the noise
// floor are not exact, because no threshold is below it.
class Band {
 public:
  explicit Band(std::span<std::uint8_t> storage) : scores_(storage) {}

  // Computes the scores of the cells that `band` covers.
  void fill(GrayView image, const Cell& band, int noise_floor) {
    x0_ = band.x0 - 1;
    y0_ = band.y0 - 1;
    // Computes whole vectors; pixels beyond the rim are not used. The keypoint margin keeps them in the
    // image's memory.
    stride_ = (band.x1 - band.x0 + 2 + 15) / 16 * 16;
    for (int y = y0_; y <= band.y1; ++y)
      segment_test_row(image.row(y) + x0_, image.stride, stride_, static_cast<std::uint8_t>(noise_floor),
                       scores_.data() + (y - y0_) * stride_);
  }

  // Number of pixels of the cell that pass at this threshold, 0 … 127.
  int count_above(const Cell& cell, int threshold) const {
    if constexpr (kSimdLoops) return count_above_by_words(cell, threshold);
    int count = 0;
    for (int x = cell.x0; x < cell.x1; x += kBytes) {
      Bytes counts = {};  // one column per byte: a cell has at most kMaxCell rows
      for (int y = cell.y0; y < cell.y1; ++y) counts -= read(x, y) > splat(threshold);
      counts &= columns_of(cell, x);
      std::uint64_t halves[2];
      std::memcpy(halves, &counts, sizeof halves);
      count += static_cast<int>(sum_of_bytes(halves[0]) + sum_of_bytes(halves[1]));
    }
    return count;
  }

  // Number of pixels of a row that are processed together.
  static constexpr int kAtOnce = kSimdLoops ? sizeof(std::size_t) : kBytes;

  // Bit i is set if pixel (x + i, y) is in the cell, passes, and is a local maximum. Among equal neighbours
  // the first one is the maximum, so the suppression has a total order.
  unsigned maxima(const Cell& cell, int x, int y, int threshold) const {
    if constexpr (kSimdLoops) return maxima_by_words(cell, x, y, threshold);
    const Bytes centre = read(x, y);
    const Bytes least =
        higher(higher(higher(read(x - 1, y - 1), read(x, y - 1)), higher(read(x + 1, y - 1), read(x - 1, y))),
               splat(threshold));
    const Bytes reached =
        higher(higher(read(x + 1, y), read(x - 1, y + 1)), higher(read(x, y + 1), read(x + 1, y + 1)));
    const Bytes is_maximum = (centre > least) & (centre >= reached);
    return set_bytes(is_maximum) & ((1U << std::min(cell.x1 - x, kBytes)) - 1);
  }

 private:
  const std::uint8_t* at(int x, int y) const { return scores_.data() + (y - y0_) * stride_ + (x - x0_); }

  // Scores beyond the cell are not used, but they still lie in the band's memory.
  Bytes read(int x, int y) const {
    Bytes scores;
    std::memcpy(&scores, at(x, y), sizeof scores);
    return scores;
  }
  static Bytes splat(int level) { return Bytes{} + static_cast<std::uint8_t>(level); }
  static Bytes higher(const Bytes& a, const Bytes& b) { return a > b ? a : b; }

  // The same for processors without SIMD registers: a processor word holds one score per byte.
  using Word = std::size_t;
  static constexpr Word kHighest = ~Word{0} / 255 * 128;  // highest bit of every byte

  int count_above_by_words(const Cell& cell, int threshold) const {
    Word count = 0;
    for (int x = cell.x0; x < cell.x1; x += kAtOnce) {
      Word counts = 0;
      for (int y = cell.y0; y < cell.y1; ++y) counts += above(cell, x, y, threshold) >> 7;
      count += sum_of_bytes(counts);
    }
    return static_cast<int>(count);
  }

  // Marks the cell's pixels that pass among the kAtOnce pixels from x on, in the highest bit of one byte
  // each.
  Word above(const Cell& cell, int x, int y, int threshold) const {
    Word scores = 0;
    std::memcpy(&scores, at(x, y), sizeof scores);
    const Word sums = (scores & ~kHighest) + (kHighest >> 7) * static_cast<Word>(127 - threshold);
    const Word hits = (sums | scores) & kHighest;
    return x + kAtOnce <= cell.x1 ? hits : hits & ((Word{1} << (8 * (cell.x1 - x))) - 1);
  }

  unsigned maxima_by_words(const Cell& cell, int x, int y, int threshold) const {
    unsigned bits = 0;
    for (Word hits = above(cell, x, y, threshold); hits != 0; hits &= hits - 1) {
      const int i = std::countr_zero(hits) / 8;
      bits |= (is_maximum(x + i, y) ? 1U : 0U) << i;
    }
    return bits;
  }

  bool is_maximum(int x, int y) const {
    const std::uint8_t* s = at(x, y);
    const std::uint8_t* above = s - stride_;
    const std::uint8_t* below = s + stride_;
    const std::uint8_t centre = *s;
    return above[-1] < centre && above[0] < centre && above[1] < centre && s[-1] < centre && s[1] <= centre &&
           below[-1] <= centre && below[0] <= centre && below[1] <= centre;
  }

  std::span<std::uint8_t> scores_;
  int x0_ = 0, y0_ = 0, stride_ = 0;  // position of the rim's first pixel, and row stride
};

// The strongest candidates of a cell, strongest first. Among equal ones, the earlier stays ahead.
class BestOfCell {
 public:
  void insert(const Candidate& candidate) {
    std::size_t i = size_;
    if (size_ < kKeypointsPerCell) {
      ++size_;
    } else {
      i = kKeypointsPerCell - 1;
      if (candidate.strength <= best_[i].strength) return;
    }
    for (; i > 0 && best_[i - 1].strength < candidate.strength; --i) best_[i] = best_[i - 1];
    best_[i] = candidate;
  }
  std::size_t size() const { return size_; }
  Candidate at(std::size_t i) const {
    Candidate candidate = best_[i];
    candidate.rank = static_cast<std::uint8_t>(i);
    return candidate;
  }

 private:
  std::array<Candidate, kKeypointsPerCell> best_;
  std::size_t size_ = 0;
};

struct Search {
  const Pyramid& pyramid;
  const DepthSampler& depth;
  const ImageMask& mask;
  const CarriedCells& carried;
  const DetectorConfig& config;
  FixedVector<Candidate>& candidates;
  int found = 0;
};

// Candidates of a cell that wait for their depth. It is not cached yet, so several are prefetched at once.
class DepthQueue {
 public:
  DepthQueue(const DepthSampler& depth, BestOfCell& best) : depth_(depth), best_(best) {}
  void push(const Candidate& candidate, int x, int y) {
    if constexpr (kSizeOptimised) {
      if (depth_.near(x, y) > 0) best_.insert(candidate);
      return;
    }
    const std::uint16_t* const place = depth_.place_of(x, y);
    if (place == nullptr) return;
    __builtin_prefetch(place);
    waiting_[size_++] = {place, candidate};
    if (size_ == waiting_.size()) settle();
  }
  // Processes the candidates in the order in which they came.
  void settle() {
    for (std::size_t i = 0; i < size_; ++i) {
      const Candidate& candidate = waiting_[i].candidate;
      if (*waiting_[i].place > 0 ||
          depth_.near(candidate.x << candidate.level, candidate.y << candidate.level) > 0)
        best_.insert(candidate);
    }
    size_ = 0;
  }

 private:
  struct Waiting {
    const std::uint16_t* place;
    Candidate candidate;
  };
  const DepthSampler& depth_;
  BestOfCell& best_;
  std::array<Waiting, kSizeOptimised ? 1 : 8> waiting_;
  std::size_t size_ = 0;
};

void search_cell(Search& search, const Band& band, int level, const Cell& cell) {
  const GrayView image = search.pyramid.level(level);
  // Halves the threshold while the cell has too few pixels, at most seven times.
  int threshold = std::max(search.config.noise_floor, contrast_threshold(image, cell));
  constexpr int kEnoughPixels = 3 * kKeypointsPerCell;
  while (threshold > search.config.noise_floor && band.count_above(cell, threshold) < kEnoughPixels)
    threshold = std::max(search.config.noise_floor, threshold / 2);
  // Neither the detector nor the refinement reads beyond the patch.
  const int reach = reach_on_base(level, kPatchRadius);
  BestOfCell best;
  DepthQueue queue(search.depth, best);
  for (int y = cell.y0; y < cell.y1; ++y) {
    for (int block = cell.x0; block < cell.x1; block += Band::kAtOnce) {
      for (unsigned maxima = band.maxima(cell, block, y, threshold); maxima != 0; maxima &= maxima - 1) {
        const int x = block + lowest_bit(maxima);
        if (!search.mask.is_free(x << level, y << level, reach)) continue;
        if (search.carried.is_carried(Vector2(x << level, y << level))) continue;
        const auto strength = static_cast<float>(corner_strength(image, x, y));
        if (strength < static_cast<float>(search.config.min_strength)) continue;
        ++search.found;
        queue.push({strength, static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                    static_cast<std::uint8_t>(level), 0},
                   x << level, y << level);
      }
    }
  }
  if constexpr (!kSizeOptimised) queue.settle();
  for (std::size_t i = 0; i < best.size(); ++i) search.candidates.push_back(best.at(i));
}

void search_level(Search& search, Band& band, int level) {
  const GrayView image = search.pyramid.level(level);
  const int size = search.config.cell_px;
  const int right = image.width - kKeypointMargin;
  if (right <= kKeypointMargin) return;
  for (int y = kKeypointMargin; y < image.height - kKeypointMargin; y += size) {
    const int bottom = std::min(y + size, image.height - kKeypointMargin);
    band.fill(image, {kKeypointMargin, y, right, bottom}, search.config.noise_floor);
    for (int x = kKeypointMargin; x < right; x += size)
      search_cell(search, band, level, {x, y, std::min(x + size, right), bottom});
  }
}

// Peak of the parabola through three samples, as an offset from the middle one in [−0.5, 0.5].
double parabola_peak(double before, double middle, double after) {
  const double curvature = before - 2 * middle + after;
  if (curvature >= 0) return 0;
  return std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5);
}

Keypoint refine(const Pyramid& pyramid, const Candidate& candidate) {
  const GrayView image = pyramid.level(candidate.level);
  const int x = candidate.x;
  const int y = candidate.y;
  const double middle = candidate.strength;
  const double dx = parabola_peak(corner_strength(image, x - 1, y), middle, corner_strength(image, x + 1, y));
  const double dy = parabola_peak(corner_strength(image, x, y - 1), middle, corner_strength(image, x, y + 1));
  const double scale = 1 << candidate.level;
  Keypoint keypoint;
  keypoint.u = static_cast<float>((x + dx) * scale);
  keypoint.v = static_cast<float>((y + dy) * scale);
  keypoint.x = candidate.x;
  keypoint.y = candidate.y;
  keypoint.level = candidate.level;
  keypoint.strength = candidate.strength;
  return keypoint;
}

// Moves the selected candidates to the front, rank by rank; of the rank that does not fit completely, the
// strongest are selected. Returns their number.
std::size_t select_best_spread(FixedVector<Candidate>& candidates, std::size_t capacity) {
  if (candidates.size() <= capacity) return candidates.size();
  // Ranks after last_rank need no sorting.
  std::array<std::size_t, kKeypointsPerCell> of_rank{};
  for (const Candidate& candidate : candidates) ++of_rank[candidate.rank];
  std::size_t last_rank = 0;
  for (std::size_t fitting = of_rank[0]; fitting < capacity; fitting += of_rank[last_rank]) ++last_rank;
  Candidate* const first = candidates.begin();
  Candidate* const end = std::partition(
      first, candidates.end(), [&](const Candidate& candidate) { return candidate.rank <= last_rank; });
  // Orders by rank, then strength, then position. The order is total, so the result does not depend on the
  // sorting algorithm.
  heap_sort(first, end, [](const Candidate& a, const Candidate& b) {
    if (a.rank != b.rank) return a.rank < b.rank;
    if (a.strength != b.strength) return a.strength > b.strength;
    if (a.level != b.level) return a.level < b.level;
    if (a.y != b.y) return a.y < b.y;
    return a.x < b.x;
  });
  return capacity;
}

}  // namespace

double corner_strength(GrayView image, int x, int y) {
  constexpr int kRadius = 3;
  constexpr int kSide = 2 * kRadius + 1;
  constexpr Int16x8 kCounts = {-1, -1, -1, -1, -1, -1, -1, 0};  // ignores the last of eight columns
  Int32x4 sums[3] = {};
  for (int r = 0; r < kSide; ++r) {
    const std::uint8_t* row = image.data + (y + r - kRadius) * image.stride + x - kRadius;
    Int16x8 left, right, above, below;
    load_bytes(row - 1, left);
    load_bytes(row + 1, right);
    load_bytes(row - image.stride, above);
    load_bytes(row + image.stride, below);
    const Int16x8 across = (right - left) & kCounts;
    const Int16x8 down = (below - above) & kCounts;
    Int32x4 pairs;
    dot_pairs(across, across, pairs);
    sums[0] += pairs;
    dot_pairs(across, down, pairs);
    sums[1] += pairs;
    dot_pairs(down, down, pairs);
    sums[2] += pairs;
  }
  const auto total = [](const Int32x4& four) { return four[0] + four[1] + four[2] + four[3]; };
  const std::int32_t xx = total(sums[0]);
  const std::int32_t xy = total(sums[1]);
  const std::int32_t yy = total(sums[2]);
  // Central differences are twice the gradient, hence the factor 4.
  constexpr double kScale = 1.0 / (4 * kSide * kSide);
  const double half_sum = 0.5 * (xx + yy);
  const double half_difference = 0.5 * (xx - yy);
  return kScale * (half_sum - sqrt(half_difference * half_difference + static_cast<double>(xy) * xy));
}

DetectionSummary detect_keypoints(const Pyramid& pyramid, const DepthSampler& depth,
                                  const DetectorConfig& config, Arena& scratch, FixedVector<Keypoint>& out,
                                  const ImageMask& mask, const CarriedCells& carried) {
  const ScratchScope scope(scratch);
  const std::span<std::uint8_t> scores =
      scratch.take<std::uint8_t>("keypoint scores", detection_band(pyramid.level(0).width, config.cell_px));
  std::size_t cells = 0;
  for (int level = 0; level < config.levels; ++level)
    cells += detection_cells(pyramid.level(level).width, pyramid.level(level).height, config.cell_px);
  FixedVector<Candidate> candidates(
      scratch.take<Candidate>("keypoint candidates", cells * kKeypointsPerCell));
  out.clear();
  if (scores.empty() || candidates.capacity() == 0) return {};

  Search search{pyramid, depth, mask, carried, config, candidates};
  Band band(scores);
  for (int level = 0; level < config.levels; ++level) search_level(search, band, level);
  const std::size_t kept = select_best_spread(candidates, out.capacity());
  for (std::size_t i = 0; i < kept; ++i) out.push_back(refine(pyramid, candidates[i]));
  out.add_dropped(candidates.size() - kept);
  return {search.found};
}

}  // namespace plvo
