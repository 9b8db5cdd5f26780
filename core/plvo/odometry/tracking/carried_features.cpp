// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/carried_features.hpp"

#include <utility>

#include "plvo/math/trigonometry.hpp"
#include "plvo/motion/coverage.hpp"
#include "plvo/points/alignment.hpp"

namespace plvo {
namespace {

// A match this near to the keypoint stayed at its pixel.
constexpr double kStayed_px = 0.3;
// A line stayed if both ends of its segment are this near to where it was.
constexpr double kStayedLine_px = 0.6;
// A keypoint takes part in the vote if the motion moves it by this much, in pixels of its level: its patch
// would then not be taken for one that stayed.
constexpr double kMoved_px = 3;
// The patch is registered around the pixel where it was. Fewer steps than those of a track suffice, and the
// patch has to be more similar: it lies where it lay, without a change of perspective.
constexpr AlignmentOptions kAtSamePixel{
    .max_iterations = 3, .max_shift_px = 2 * kStayed_px, .max_residual = 0.25};
// Depth contradicts rest if at least kLeastContradicted points stayed, and for over a third of them
// the depth has changed by more than kOtherDepthSigmas SDs.
constexpr int kLeastContradicted = 30;
constexpr double kOtherDepthSigmas = 3;
// Nearly all matches are points that stayed if there are this many times as many as others.
constexpr int kTimesTheOthers = 3;
// The other matches must support their own motion this many times as much as that of the points that stayed,
// and this share of its inliers must lie in cells with such points.
constexpr int kTimesTheSupport = 3;
constexpr double kShareAmong = 0.25;
// A line is looked up in the cells at this many places along it.
constexpr int kPlacesOfLine = 5;

Vector2 pixel_of(const Keypoint& keypoint) {
  return {static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)};
}

bool is_within(const Vector2& a, const Vector2& b, double radius) {
  return (a - b).squaredNorm() < radius * radius;
}

bool has_stayed(const FrameFeatures& features, const PointTracks& points, const Match& match) {
  return is_within(points.pixels[match.current], pixel_of(features.points.keypoints[match.reference]),
                   kStayed_px);
}

bool has_other_depth(const Point3d& before, const Point3d& now) {
  if (!(before.p.z() > 0 && now.p.z() > 0)) return false;
  const double change = now.p.z() - before.p.z();
  return change * change > kOtherDepthSigmas * kOtherDepthSigmas * (before.Sigma(2, 2) + now.Sigma(2, 2));
}

bool has_stayed(const Segment& before, const Segment& now) {
  const Vector2 across = before.normal();
  const auto is_near = [&](const Vector2& end) {
    const double offset = across.dot(end - before.a);
    return offset * offset < kStayedLine_px * kStayedLine_px;
  };
  return is_near(now.a) && is_near(now.b);
}

}  // namespace

[[gnu::noinline]] void vote_for_carried(const CurrentFrame& current, const PointFeatures& points,
                                        const ReferenceTracks& tracks, const Se3& T_current_reference,
                                        CarriedCells& cells) {
  Arena& scratch = current.context.scratch;
  const ScratchScope scope(scratch);
  const std::span<std::uint8_t> is_inlier =
      scratch.take<std::uint8_t>("points found", points.keypoints.size());
  if (is_inlier.size() < points.keypoints.size()) return;
  for (std::uint8_t& flag : is_inlier) flag = 0;
  for (std::size_t i = 0; i < tracks.points.matches.size(); ++i)
    is_inlier[tracks.points.matches[i].reference] = tracks.point_inliers[i];

  CarriedCells::Counts stayed{}, moved{};
  for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
    const Keypoint& keypoint = points.keypoints[i];
    if (!(points.points[i].p.z() > 0)) continue;
    const Vector3 p = T_current_reference * points.points[i].p;
    if (!(p.z() > kNearestSeen_m)) continue;
    if (is_within(project(current.context.camera.pinhole, p), pixel_of(keypoint),
                  kMoved_px * (1 << keypoint.level)))
      continue;
    const std::size_t cell = cells.cell_of(keypoint);
    if (is_inlier[i] != 0) {
      ++moved[cell];
      continue;
    }
    const Vector2 at(keypoint.x, keypoint.y);
    const Alignment found =
        align_patch(points.patches[i], points.masks[i], current.extraction.pyramid().level(keypoint.level),
                    at.x(), at.y(), kAtSamePixel);
    if (found.ok && is_within({found.x, found.y}, at, kStayed_px)) ++stayed[cell];
  }
  cells.vote(stayed, moved);
}

[[gnu::noinline]] void leave_carried_lines_out(std::span<const Reference> references,
                                               const LineFeatures& current, const CarriedCells& cells,
                                               std::span<ReferenceTracks> tracks) {
  if (cells.count() == 0 || cells.has_light()) return;
  const auto is_of_robot = [&](const Segment& before, const Match& match) {
    return cells.is_carried(before.middle()) && has_stayed(before, current.segments[match.current]);
  };
  int others = 0, moved = 0;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& features = *references[r].features;
    for (const Match& match : tracks[r].points.matches) {
      ++others;
      moved += has_stayed(features, tracks[r].points, match) ? 0 : 1;
    }
    for (const Match& match : tracks[r].lines) {
      const Segment& before = features.lines.segments[match.reference];
      if (is_of_robot(before, match)) continue;
      ++others;
      moved += has_stayed(before, current.segments[match.current]) ? 0 : 1;
    }
  }
  if (2 * moved <= others) return;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FixedVector<Segment>& segments = references[r].features->lines.segments;
    FixedVector<Match>& lines = tracks[r].lines;
    std::size_t kept = 0;
    for (const Match& match : lines)
      if (!is_of_robot(segments[match.reference], match)) lines[kept++] = match;
    lines.resize(kept);
  }
}

StayedMatches count_stayed(std::span<const Reference> references, std::span<const ReferenceTracks> tracks,
                           const CarriedCells& cells) {
  StayedMatches counts;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& features = *references[r].features;
    const PointTracks& points = tracks[r].points;
    for (std::size_t i = 0; i < points.matches.size(); ++i) {
      const int inlier = tracks[r].point_inliers[i];
      if (has_stayed(features, points, points.matches[i])) {
        ++counts.cells[cells.cell_of(features.points.keypoints[points.matches[i].reference])];
        ++counts.stayed;
        counts.stayed_inliers += inlier;
        if (has_other_depth(features.points.points[points.matches[i].reference], points.points[i]))
          ++counts.other_depth;
      } else {
        ++counts.others;
        counts.other_inliers += inlier;
      }
    }
    counts.others += static_cast<int>(tracks[r].lines.size());
    for (std::size_t i = 0; i < tracks[r].lines.size(); ++i)
      counts.other_inliers += tracks[r].line_inliers[i];
  }
  return counts;
}

bool depth_contradicts(const StayedMatches& before) {
  return before.stayed >= kLeastContradicted && 3 * before.other_depth > before.stayed;
}

bool may_be_misled(const StayedMatches& before) {
  return before.stayed_inliers > before.others && 2 * before.other_inliers < before.others;
}

bool contradicts_rest(const StayedMatches& before, double explained) {
  return before.stayed_inliers > kTimesTheOthers * before.others && explained < kWorldAtRest;
}

std::size_t leave_stayed_out(const Reference& reference, ReferenceTracks& tracks) {
  PointTracks& points = tracks.points;
  const std::size_t size = points.matches.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (has_stayed(*reference.features, points, points.matches[i])) continue;
    std::swap(points.matches[i].reference, points.matches[kept].reference);
    std::swap(points.pixels[i], points.pixels[kept]);
    std::swap(points.points[i], points.points[kept]);
    ++kept;
  }
  points.matches.resize(kept);
  return size;
}

bool agree_among_stayed(const StayedMatches& before, std::span<const Reference> references,
                        std::span<const ReferenceTracks> tracks, const CameraModel& camera,
                        const CarriedCells& cells) {
  int inliers = 0;
  double among = 0;
  const auto is_among = [&](const Vector3& p) {
    return before.cells[cells.cell_of(project(camera.pinhole, p))] > 0;
  };
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& features = *references[r].features;
    for (std::size_t i = 0; i < tracks[r].points.matches.size(); ++i) {
      if (tracks[r].point_inliers[i] == 0) continue;
      ++inliers;
      among += is_among(features.points.points[tracks[r].points.matches[i].reference].p) ? 1 : 0;
    }
    for (std::size_t i = 0; i < tracks[r].lines.size(); ++i) {
      if (tracks[r].line_inliers[i] == 0) continue;
      ++inliers;
      const Line3d& line = features.lines.lines_3d()[tracks[r].lines[i].reference];
      for (int place = 0; place < kPlacesOfLine; ++place) {
        const double share = place / (kPlacesOfLine - 1.0);
        among += is_among((1 - share) * line.a + share * line.b) ? 1.0 / kPlacesOfLine : 0;
      }
    }
  }
  return 2 * inliers > before.others && inliers > kTimesTheSupport * before.other_inliers &&
         among > kShareAmong * inliers;
}

}  // namespace plvo
