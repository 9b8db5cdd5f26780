// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/motion_search.hpp"

namespace plvo {
namespace {

// A first motion is accepted if at least this share of the features that it puts into the image are found. A
// wrongly aligned image mostly finds less than a tenth. A search by features finds up to a fifth when it is a
// brick off before a wall that repeats itself. A correct motion in a blurred image may find as little: it is
// not refused, but other motions are searched as well.
constexpr double kAcceptedShareByImage = 0.1;
constexpr double kAcceptedShareByFeatures = 0.2;
// A motion is also accepted if two searches lead to it: within this distance (m and rad).
constexpr double kSameMotion = 0.02;
// When tracking fails, features are searched this far from their old positions, whatever the prediction.
constexpr double kWideSearch_px = 120;

// Whether the number of inliers is at least this share of the features that the motion from the base puts
// into the image: points, and lines by their midpoints, of all references.
bool is_share_of_view(int inliers, double share, std::span<const Reference> references,
                      const CameraModel& camera, const Se3& T_current_base) {
  // Nearly always the inliers are that share of all features, in view or not.
  std::size_t all = 0;
  for (const Reference& reference : references)
    all += reference.features->points.keypoints.size() + reference.features->lines.count_3d;
  if (inliers >= share * static_cast<double>(all)) return true;
  int in_view = 0;
  for (const Reference& reference : references) {
    const Se3 T_current_reference = T_current_base * reference.pose.T_reference_base.inverse();
    const auto is_seen = [&](const Vector3& p) {
      const Vector3 here = T_current_reference * p;
      if (!(here.z() > kNearestSeen_m)) return false;
      const Vector2 at = project(camera.pinhole, here);
      return at.x() >= 0 && at.y() >= 0 && at.x() <= camera.width - 1 && at.y() <= camera.height - 1;
    };
    const PointFeatures& points = reference.features->points;
    for (const Point3d& point : points.points.first(points.keypoints.size()))
      in_view += point.p.z() > 0 && is_seen(point.p) ? 1 : 0;
    for (const Line3d& line : reference.features->lines.lines_3d())
      in_view += is_seen(0.5 * (line.a + line.b)) ? 1 : 0;
  }
  return inliers >= share * in_view;
}

// Whether the reference can be searched by descriptors: those of a recent frame are not computed.
bool is_findable(const Reference& reference) {
  const PointFeatures& points = reference.features->points;
  return points.described || points.keypoints.empty();
}

}  // namespace

// Not inlined: its variables are on the stack during the search alone.
[[gnu::noinline]] TrackedMotion search_motion(const CurrentFrame& current, ReferenceTracking& tracking) {
  TrackedMotion tracked;
  const std::span<const Reference> references = current.predicted.references();
  const StageContext& context = current.context;
  const Config& config = context.config;
  const Reference& latest = references[latest_of(references)];
  const bool registered = config.points.registered;
  const auto refine = [&](const Se3& T_current_base) {
    tracking.refine(references, current, T_current_base, tracked);
    return tracked.ok();
  };
  // The best of the motions that were not accepted: its result, its start, and its number of inliers.
  struct {
    Se3 motion, start;
    int inliers = 0;
  } best;
  bool last_is_best = false;  // nothing was tried since
  const auto is_accepted = [&](const Se3& start, double share) {
    const Se3& motion = tracked.motion.T_current_reference;
    const int inliers = tracked.inliers();
    if (is_share_of_view(inliers, share, references, context.camera, motion)) return true;
    last_is_best = inliers > best.inliers;
    if (last_is_best) best = {motion, start, inliers};
    return false;
  };
  const auto find = [&](const Reference& from, const Se3& T_predicted, double radius_px) {
    last_is_best = false;
    tracking.find(from, current, T_predicted, radius_px, tracked);
    if (!tracked.ok()) return false;
    if (!registered) return true;
    const Se3 start = tracked.motion.T_current_reference * from.pose.T_reference_base;
    if (best.inliers > 0 && boxminus(start, best.motion).norm() < kSameMotion) return refine(best.start);
    return refine(start) && is_accepted(start, kAcceptedShareByFeatures);
  };

  if (Se3 start; registered && tracking.align(latest, current, start)) {
    start = start * latest.pose.T_reference_base;
    if (refine(start) && is_accepted(start, kAcceptedShareByImage)) return tracked;
  }
  current.find_points();
  current.describe_points();
  const Reference& nearest = is_findable(latest) ? latest : references[0];
  bool accepted = find(nearest, nearest.T_current_predicted, PointMatchConfig().radius_px);
  for (std::size_t r = references.size(); r-- > 0 && !accepted;) {
    const Reference& reference = references[r];
    if (!is_findable(reference)) continue;
    accepted = find(reference, current.predicted.sensed.known() ? reference.T_current_predicted : Se3{},
                    kWideSearch_px);
  }
  if (!accepted && best.inliers > 0 && !last_is_best) (void)refine(best.start);
  return tracked;
}

}  // namespace plvo
