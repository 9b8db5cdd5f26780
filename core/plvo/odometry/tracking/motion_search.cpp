// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/motion_search.hpp"

#include <utility>

#include "plvo/math/trigonometry.hpp"
#include "plvo/motion/coverage.hpp"

namespace plvo {
namespace {

// A first motion is accepted if at least this share of the evidence that it puts into the image is found.
// After a wrong alignment of the image, mostly less than a tenth is found. Before a wall that repeats itself,
// a motion that is wrong by one brick finds up to a fifth. A correct motion in a blurred image may find as
// little: it is not refused, but other motions are searched as well.
constexpr double kAcceptedShareByImage = 0.1;
constexpr double kAcceptedShareByFeatures = 0.2;
// If the estimate is another motion than that of the start, features are registered again with the estimate,
// at most this many times in all: features that follow the new motion are then found.
constexpr int kMostRegistrations = 3;
// The image may be aligned to an object. Where the aligned and the predicted motion differ by more than this
// in the plane z = 1 (4 px of a Kinect), a glance at both tells which one to start from. Otherwise
// registration finds the same features from both.
constexpr double kSameStart = 4.0 / 525;
// The estimates of two glances are different motions if they differ by more than this in the plane z = 1 (2
// px of a Kinect). If both explain about as much, the one from the prediction is taken, because a camera
// mostly keeps its velocity. If they are the same motion, the aligned one is taken, because it is nearer to
// it than a prediction that is 4 px off; but not if it explains clearly less.
constexpr double kOtherMotion = 2.0 / 525;
// A motion that a prior contradicts counts as explaining this share of what it explains.
constexpr double kWorthOfContradicted = 0.25;
// When tracking fails, features are searched this far from their old positions, whatever the prediction.
constexpr double kWideSearch_px = 120;

// Evidence (coverage.hpp) of the inliers, and its share of that of all features in view.
struct Explained {
  double evidence = 0;
  double share = 0;
};

// Calls visit(extent) for the 3D points and lines of a reference.
template <typename Visit>
void for_each_extent(const FrameFeatures& features, const Visit& visit) {
  for (const Point3d& point : features.points.points.first(features.points.keypoints.size()))
    if (point.p.z() > 0) visit(extent_of(point));
  for (const Line3d& line : features.lines.lines_3d()) visit(extent_of(line));
}

// What the motion from the base explains of the view of all references. Not inlined: the cells would
// otherwise stay on the stack during the search.
[[gnu::noinline]] Explained explained_by(const Se3& T_current_base, std::span<const Reference> references,
                                         const ReferenceTracking& tracking, const CameraModel& camera) {
  Coverage coverage;
  Explained found;
  double all = 0;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& features = *references[r].features;
    const ReferenceTracks& tracks = tracking.tracks(r);
    const Se3 T_current_reference = T_current_base * references[r].pose.T_reference_base.inverse();
    const auto each_in_view = [&](const auto& visit) {
      for_each_extent(features, [&](const Extent& extent) {
        const Vector3 here = T_current_reference * extent.middle;
        if (!(here.z() > kNearestSeen_m)) return;
        const Vector2 at = project(camera.pinhole, here);
        if (at.x() >= 0 && at.y() >= 0 && at.x() <= camera.width - 1 && at.y() <= camera.height - 1)
          visit(extent);
      });
    };
    coverage.clear();
    each_in_view([&](const Extent& extent) { coverage.count(extent); });
    each_in_view([&](const Extent& extent) { all += coverage.evidence(extent); });
    for (std::size_t i = 0; i < tracks.points.matches.size(); ++i)
      if (tracks.point_inliers[i] != 0)
        found.evidence +=
            coverage.evidence(extent_of(features.points.points[tracks.points.matches[i].reference]));
    for (std::size_t i = 0; i < tracks.lines.size(); ++i)
      if (tracks.line_inliers[i] != 0)
        found.evidence += coverage.evidence(extent_of(features.lines.lines_3d()[tracks.lines[i].reference]));
  }
  if (all > 0) found.share = found.evidence / all;
  return found;
}

// Mean distance in the plane z = 1 between where two motions put the features of a reference.
double distance_between(const Se3& a, const Se3& b, const FrameFeatures& features) {
  double sum = 0;
  int n = 0;
  for_each_extent(features, [&](const Extent& extent) {
    const Vector3 at_a = a * extent.middle;
    const Vector3 at_b = b * extent.middle;
    if (!(at_a.z() > kNearestSeen_m && at_b.z() > kNearestSeen_m)) return;
    sum += sqrt((at_a / at_a.z() - at_b / at_b.z()).squaredNorm());
    ++n;
  });
  return n > 0 ? sum / n : 0;
}

// Whether the reference can be searched by descriptors: those of a recent frame are not computed.
bool is_findable(const Reference& reference) {
  const PointFeatures& points = reference.features->points;
  return points.described || points.keypoints.empty();
}

}  // namespace

// Not inlined: its variables are on the stack only during the search.
[[gnu::noinline]] void search_motion(const CurrentFrame& current, ReferenceTracking& tracking,
                                     TrackedMotion& tracked) {
  const std::span<const Reference> references = current.predicted.references;
  const StageContext& context = current.context;
  const Config& config = context.config;
  const Reference& latest = references[latest_of(references)];
  const bool registered = config.points.registered;
  const auto refine = [&](Se3 T_current_base) {
    for (int i = 0; i < kMostRegistrations; ++i) {
      tracking.refine(references, current, T_current_base, tracked);
      if (!tracked.ok() || !tracked.motion.is_other) break;
      T_current_base = tracked.motion.T_current_reference;
    }
    return tracked.ok();
  };
  const auto explained_by_tracked = [&] {
    Explained explained =
        explained_by(tracked.motion.T_current_reference, references, tracking, context.camera);
    if (tracked.motion.contradicted) explained.evidence *= kWorthOfContradicted;
    return explained;
  };
  // The start of the motion that explains most so far, the motion, and what it explains.
  struct {
    Se3 start, motion;
    Explained explained;
  } best;
  bool last_is_best = false;  // nothing was tried since
  // times: how much more than the best before it has to explain, to become the best.
  const auto explain = [&](const Se3& start, double times = 1) {
    Explained explained;
    if (refine(start)) explained = explained_by_tracked();
    last_is_best = explained.evidence > times * best.explained.evidence;
    if (last_is_best) best = {start, tracked.motion.T_current_reference, explained};
    return explained;
  };
  const auto glance = [&](const Se3& start) {
    tracking.glance(references, current, start, tracked);
    return tracked.ok() ? explained_by_tracked() : Explained{};
  };
  const auto take_best = [&] {
    if (!last_is_best && best.explained.evidence > 0) (void)refine(best.start);
  };
  const auto is_other_motion = [&](const Se3& a, const Se3& b) {
    const Se3 T_base_latest = latest.pose.T_reference_base.inverse();
    return distance_between(a * T_base_latest, b * T_base_latest, *latest.features) > kOtherMotion;
  };
  const auto find = [&](const Reference& from, const Se3& T_predicted, double radius_px) {
    last_is_best = false;
    tracking.find(from, current, T_predicted, radius_px, tracked);
    if (!tracked.ok()) return false;
    if (!registered) return true;
    const Se3 start = tracked.motion.T_current_reference * from.pose.T_reference_base;
    // A motion is also accepted if two searches lead to it.
    if (best.explained.evidence > 0 && !is_other_motion(start, best.motion)) return refine(best.start);
    return explain(start).share >= kAcceptedShareByFeatures;
  };

  if (Se3 aligned; registered && tracking.align(latest, current, aligned)) {
    const Se3 by_prediction = latest.T_current_predicted * latest.pose.T_reference_base;
    Se3 start = aligned * latest.pose.T_reference_base;
    const bool compare = distance_between(aligned, latest.T_current_predicted, *latest.features) > kSameStart;
    Se3 rival = start;
    bool has_rival = false;
    if (compare) {
      const Explained by_image = glance(start);
      const bool image_leads = tracked.ok();
      if (image_leads) start = tracked.motion.T_current_reference;
      const Explained predicted = glance(by_prediction);
      if (tracked.ok()) {
        rival = tracked.motion.T_current_reference;
        const bool is_other = !image_leads || is_other_motion(start, rival);
        const double least = is_other ? kComparableShare : 1 / kComparableShare;
        if (predicted.evidence > least * by_image.evidence) std::swap(start, rival);
        has_rival = is_other && are_comparable(predicted.evidence, by_image.evidence);
      }
    }
    const Explained found = explain(start);
    if (has_rival && tracked.ok() && is_other_motion(rival, tracked.motion.T_current_reference))
      tracked.motion.contain(boxminus(rival, tracked.motion.T_current_reference));
    if (found.share >= kAcceptedShareByImage) {
      if (!compare && (tracked.motion.explained < kWorldAtRest || tracked.motion.contradicted)) {
        explain(by_prediction, 1 / kComparableShare);
        take_best();
      }
      return;
    }
  }
  current.describe_points();
  const Reference& nearest = is_findable(latest) ? latest : references[0];
  bool accepted = find(nearest, nearest.T_current_predicted, PointMatchConfig().radius_px);
  for (std::size_t r = references.size(); r-- > 0 && !accepted;) {
    const Reference& reference = references[r];
    if (!is_findable(reference)) continue;
    accepted = find(reference, current.predicted.sensed.known() ? reference.T_current_predicted : Se3{},
                    kWideSearch_px);
  }
  if (!accepted) take_best();
}

}  // namespace plvo
