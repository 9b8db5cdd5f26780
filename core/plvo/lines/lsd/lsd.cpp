// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/lsd.hpp"

#include <algorithm>
#include <array>

#include "plvo/base/heap_sort.hpp"
#include "plvo/lines/lsd/edge_localisation.hpp"
#include "plvo/lines/lsd/line_validation.hpp"

namespace plvo {
namespace {

constexpr int kCellColumns = 6;
constexpr int kCellRows = 4;
// Uncertainty of a rectangle's axis before localisation in the full image, in pixels of the reduced one.
constexpr double kAxisSd_px = 0.15;

std::size_t cell_of(const Vector2& middle, int width, int height) {
  const int column = std::clamp(static_cast<int>(middle.x() * kCellColumns / width), 0, kCellColumns - 1);
  const int row = std::clamp(static_cast<int>(middle.y() * kCellRows / height), 0, kCellRows - 1);
  return static_cast<std::size_t>(row * kCellColumns + column);
}

}  // namespace

void SegmentDetector::search(GrayView band, const lsd::FieldMask& masked, Scratch& scratch,
                             SegmentCounts& counts) const {
  lsd::LevelLineField& field = scratch.field;
  field.height = band.height - 1;
  lsd::compute_field(band, field, masked);
  counts.directed_pixels += static_cast<std::int32_t>(field.seed_count);
  const auto min_size = static_cast<std::int32_t>(min_region(search_.width, search_.height));
  for (const lsd::PixelRun seed : field.seeds.first(field.seed_count)) {
    if ((field.open()[field.index(seed)] & seed.bits) == 0) continue;
    lsd::Region region = lsd::grow(field, seed, lsd::kTau, scratch.region);
    counts.grown_pixels += region.size;
    if (region.size < min_size) continue;
    lsd::GradientMass mass = lsd::weigh(field, region);
    lsd::Rectangle rectangle = lsd::fit_rectangle(region, mass);
    if (!lsd::is_dense(rectangle, region.size)) {
      const bool tightened = lsd::tighten(field, region, mass, rectangle, min_size, scratch.region);
      counts.grown_pixels += region.size;
      if (!tightened) continue;
    }
    const double meaningfulness = lsd::meaningfulness(field, false_alarms_, rectangle);
    if (meaningfulness < 0) continue;
    const auto found = static_cast<std::size_t>(counts.meaningful++);
    if (found < scratch.candidates.size())
      scratch.candidates[found] = describe(rectangle, masked.row_0, meaningfulness);
  }
}

SegmentDetector::Candidate SegmentDetector::describe(const lsd::Rectangle& rectangle, int row_0,
                                                     double meaningfulness) {
  // Entry (x, y) of the field is at (x + ½, y + ½) of the image.
  const Vector2 centre(rectangle.x_q8 / 256.0 + 0.5, rectangle.y_q8 / 256.0 + 0.5 + row_0);
  const Vector2 direction(rectangle.dx / 16384.0, rectangle.dy / 16384.0);
  Candidate candidate;
  candidate.a = centre + direction * (rectangle.along_min / 256.0);
  candidate.b = centre + direction * (rectangle.along_max / 256.0);
  candidate.meaningfulness = meaningfulness;
  return candidate;
}

std::size_t SegmentDetector::select(std::span<Candidate> candidates, std::size_t capacity) const {
  // Candidates are found in a fixed order, which resolves all ties. Before ranks are assigned, the most
  // meaningful comes first.
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].order = static_cast<std::int32_t>(i);
  const auto sort = [](std::span<Candidate> some) {
    heap_sort(some.data(), some.data() + some.size(), [](const Candidate& p, const Candidate& q) {
      if (p.rank != q.rank) return p.rank < q.rank;
      return p.meaningfulness != q.meaningfulness ? p.meaningfulness > q.meaningfulness : p.order < q.order;
    });
  };
  sort(candidates);
  if (candidates.size() <= capacity) return candidates.size();
  std::array<std::int32_t, kCellColumns * kCellRows> in_cell{};
  for (Candidate& candidate : candidates) {
    candidate.rank = in_cell[cell_of(0.5 * (candidate.a + candidate.b), search_.width, search_.height)]++;
  }
  sort(candidates.subspan(capacity / 2));
  const std::span<Candidate> kept = candidates.first(capacity);
  for (Candidate& candidate : kept) candidate.rank = 0;
  sort(kept);
  return capacity;
}

Status SegmentDetector::detect(GrayView reduced, double scale, GrayView full, Arena& scratch_memory,
                               FixedVector<Segment>& out, SegmentCounts* counts,
                               const ImageMask& mask) const {
  out.clear();
  if (reduced.data == nullptr || full.data == nullptr || reduced.width != search_.width ||
      reduced.height != search_.height) {
    return {StatusCode::kInvalidArgument,
            "lines: the image is missing or not of the size that init() was given"};
  }
  if (reduced.width > lsd::LevelLineField::kMostWidth) {
    return Status(StatusCode::kInvalidArgument,
                  "lines: the image is too wide; the largest width in pixels is ")
        .append(lsd::LevelLineField::kMostWidth);
  }
  const ScratchScope scope(scratch_memory);
  Scratch scratch = allocate(scratch_memory, search_);
  if (scratch.candidates.empty()) {
    return {StatusCode::kOutOfMemory, "lines: the scratch memory is too small for this image size"};
  }
  SegmentCounts done;
  const int rows = band_rows(search_);
  for (int row = 0; row + 1 < reduced.height; row += rows)
    search({reduced.row(row), reduced.width, std::min(rows + 1, reduced.height - row), reduced.stride},
           {&mask, scale, row}, scratch, done);
  const auto meaningful = static_cast<std::size_t>(done.meaningful);
  const std::span<Candidate> candidates =
      scratch.candidates.first(std::min(meaningful, scratch.candidates.size()));
  const std::size_t kept = select(candidates, out.capacity());
  out.add_dropped(meaningful - kept);
  for (const Candidate& candidate : candidates.first(kept)) {
    Segment segment;
    segment.a = candidate.a * scale;
    segment.b = candidate.b * scale;
    segment.meaningfulness = candidate.meaningfulness;
    (void)lsd::localise(full, kAxisSd_px * scale, segment);
    out.push_back(segment);
  }
  if (counts != nullptr) *counts = done;
  return {};
}

}  // namespace plvo
