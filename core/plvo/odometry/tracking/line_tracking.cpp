// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/line_tracking.hpp"

namespace plvo {
namespace {

// The segment where the motion puts its line. A line out of view goes far outside the image, where it has no
// match.
Segment predict(const Pinhole& pinhole, const Exposure& exposure, const Segment& segment, const Line3d& line,
                const Se3& T_current_reference) {
  constexpr double kNowhere_px = -1e5;
  Segment predicted = segment;
  const Vector3 a = exposure.as_seen(T_current_reference * line.a);
  const Vector3 b = exposure.as_seen(T_current_reference * line.b);
  if (a.z() > kNearestSeen_m && b.z() > kNearestSeen_m) {
    predicted.a = project(pinhole, a);
    predicted.b = project(pinhole, b);
  } else {
    predicted.a = Vector2(kNowhere_px, kNowhere_px);
    predicted.b = Vector2(kNowhere_px + 1, kNowhere_px);
  }
  return predicted;
}

}  // namespace

void match_predicted_lines(const Pinhole& pinhole, const Exposure& exposure, const LineFeatures& reference,
                           std::span<const Line3d> reference_lines, const LineFeatures& current,
                           const Se3& T_current_reference, const LineMatchConfig& gates, Arena& scratch,
                           FixedVector<Match>& matches) {
  matches.clear();
  const ScratchScope scope(scratch);
  const std::span<Segment> predicted = scratch.take<Segment>("predicted segments", reference.count_3d);
  if (predicted.size() < reference.count_3d) return;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    predicted[i] = predict(pinhole, exposure, reference.segments[i], reference_lines[i], T_current_reference);
  match_lines(predicted, reference.descriptors_3d(), current.segments_3d(), current.descriptors_3d(), gates,
              scratch, matches);
}

}  // namespace plvo
