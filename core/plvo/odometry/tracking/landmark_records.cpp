// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/landmark_records.hpp"

#include <algorithm>
#include <array>

namespace plvo {
namespace {

// A new landmark this near to one that was found is taken to be that landmark again, and has its record. The
// detector places a corner on a whole pixel of its pyramid level, so it is not found again at the same place.
constexpr double kSameLandmark_px = 3;
// Any other new landmark inherits at most this balance from its part of the image, and at least −1: one frame
// decides whether it is proven, or trusted.
constexpr int kMostInherited = LandmarkRecord::kProven - 1;
constexpr int kLeastInherited = -1;

// Sum and number of the records in each cell of the image.
class RecordsByCell {
 public:
  explicit RecordsByCell(const CurrentFrame& current)
      : pinhole_(current.context.camera.pinhole), cells_(current.context.carried) {}

  void add(const Vector2& pixel, const LandmarkRecord& record) {
    Cell& cell = at(pixel);
    cell.sum = static_cast<std::int16_t>(cell.sum + record.balance());
    ++cell.count;
  }
  void add(const Line3d& where, const LandmarkRecord& record) {
    for_each_place(where, [&](const Vector2& pixel) { add(pixel, record); });
  }
  LandmarkRecord inherited(const Vector2& pixel) { return LandmarkRecord(mean(at(pixel))); }
  LandmarkRecord inherited(const Line3d& line) {
    int least = kMostInherited;
    for_each_place(line, [&](const Vector2& pixel) { least = std::min(least, mean(at(pixel))); });
    return LandmarkRecord(least);
  }

 private:
  struct Cell {
    std::int16_t sum = 0, count = 0;
  };
  Cell& at(const Vector2& pixel) { return all_[cells_.cell_of(pixel)]; }
  static int mean(const Cell& cell) {
    if (cell.sum < 0) return kLeastInherited;
    return cell.count > 0 ? std::min(cell.sum / cell.count, kMostInherited) : 0;
  }
  // The ends and the middle of a line.
  template <typename Visit>
  void for_each_place(const Line3d& line, const Visit& visit) const {
    for (const double share : {0.0, 0.5, 1.0})
      visit(project(pinhole_, (1 - share) * line.a + share * line.b));
  }

  const Pinhole& pinhole_;
  const CarriedCells& cells_;
  std::array<Cell, CarriedCells::kCells> all_{};
};

// Gives each keypoint the record of the landmark that was found nearest to it, if that is near enough.
void keep_records(const Window& window, std::span<const int> references, const ReferenceTracking& tracking,
                  const CurrentFrame& current) {
  PointFeatures& points = current.features.points;
  Arena& scratch = current.context.scratch;
  const ScratchScope scope(scratch);
  const CameraModel& camera = current.context.camera;
  const KeypointBuckets buckets(points.keypoints, camera.width, camera.height, scratch);
  const std::span<double> nearest = scratch.take<double>("same landmarks", points.keypoints.size());
  if (nearest.size() < points.keypoints.size()) return;
  std::fill(nearest.begin(), nearest.end(), kSameLandmark_px * kSameLandmark_px);
  for (std::size_t r = 0; r < references.size(); ++r) {
    const std::span<const Point3d> landmarks = window[references[r]].features.points.points;
    const PointTracks& tracks = tracking.tracks(r).points;
    for (const Match& match : tracks.matches.span()) {
      const Vector2& found = tracks.pixels[match.current];
      buckets.for_each_near(found.x(), found.y(), kSameLandmark_px, [&](std::uint16_t i) {
        const Keypoint& keypoint = points.keypoints[i];
        const Vector2 at(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v));
        const double distance = (found - at).squaredNorm();
        if (distance >= nearest[i]) return;
        nearest[i] = distance;
        points.points[i].record = landmarks[match.reference].record;
      });
    }
  }
}

}  // namespace

void note_records(const ReferenceTracks& tracks, FrameFeatures& reference) {
  for (std::size_t i = 0; i < tracks.points.matches.size(); ++i)
    reference.points.points[tracks.points.matches[i].reference].record.add(tracks.point_inliers[i] != 0);
  for (std::size_t i = 0; i < tracks.lines.size(); ++i)
    reference.lines.lines[tracks.lines[i].reference].record.add(tracks.line_inliers[i] != 0);
}

// Not inlined: the cells are on the stack only during this function.
[[gnu::noinline]] void inherit_records(const Window& window, std::span<const int> references,
                                       const ReferenceTracking& tracking, const CurrentFrame& current) {
  RecordsByCell cells(current);
  FrameFeatures& features = current.features;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& reference = window[references[r]].features;
    const ReferenceTracks& tracks = tracking.tracks(r);
    for (const Match& match : tracks.points.matches.span())
      cells.add(tracks.points.pixels[match.current], reference.points.points[match.reference].record);
    for (const Match& match : tracks.lines.span())
      cells.add(features.lines.lines[match.current], reference.lines.lines[match.reference].record);
  }
  for (std::size_t i = 0; i < features.points.keypoints.size(); ++i) {
    const Keypoint& keypoint = features.points.keypoints[i];
    features.points.points[i].record =
        cells.inherited(Vector2(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)));
  }
  keep_records(window, references, tracking, current);
  for (std::size_t i = 0; i < features.lines.count_3d; ++i)
    features.lines.lines[i].record = cells.inherited(features.lines.lines[i]);
  // A matched line is that landmark again. The keyframe, the first reference, knows it longest.
  for (std::size_t r = references.size(); r-- > 0;)
    for (const Match& match : tracking.tracks(r).lines.span())
      features.lines.lines[match.current].record =
          window[references[r]].features.lines.lines[match.reference].record;
}

}  // namespace plvo
