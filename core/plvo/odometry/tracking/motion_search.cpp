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
// A motion is not that of the camera if it explains less than this share of the evidence of the proven
// landmarks in view, and if they are less than this share of what it explains. In 2,500 estimates of scenes
// at rest the larger of the two shares was at least 0.23; where an object is followed instead of the scene,
// both are mostly 0.
constexpr double kLeastOfProven = 0.1;
// Proven landmarks with less than this share of the evidence in view say nothing: after a fast rotation they
// are a few at the border.
constexpr double kFewProven = 0.25;
// If the estimate is another motion than that of the start, features are registered again with the estimate,
// at most this many times in all: features that follow the new motion are then found.
constexpr int kMostRegistrations = 3;
// The image may be aligned to an object. Where the aligned and the predicted motion differ by more than this
// in the plane z = 1 (4 px of a Kinect), a rough estimate from each (a glance) decides which one to
// start from. If they differ by less, registration finds the same features from both.
constexpr double kSameStart = 4.0 / 525;
// The estimates of two glances are different motions if they differ by more than this in the plane z = 1 (2
// px of a Kinect). If both explain about as much, the one from the prediction is taken, because a camera
// mostly keeps its velocity. If both glances end in the same motion, the aligned start is taken,
// because it is nearer to that motion than the prediction, which is 4 px off. The prediction is
// taken only if it explains clearly more.
constexpr double kOtherMotion = 2.0 / 525;
// Factor on the evidence of a motion that a prior or the proven landmarks contradict, when motions are
// compared. Such a motion may still be accepted, because the prior may be wrong.
constexpr double kWorthOfContradicted = 0.25;
// When tracking fails, features are searched this far from where the propagated prior puts them or, without
// one, from their old positions. The velocity is not used.
constexpr double kWideSearch_px = 120;

// Evidence (coverage.hpp) of the inliers, and its share of that of all features in view.
struct Explained {
  double evidence = 0;
  double share = 0;
  bool explains_proven = true;  // enough of the proven landmarks in view
};

// Calls visit(extent) for the 3D points and lines of a reference.
template <typename Visit>
void for_each_extent(const FrameFeatures& features, const Visit& visit) {
  for (const Point3d& point : features.points.points.first(features.points.keypoints.size()))
    if (point.p.z() > 0) visit(extent_of(point));
  for (const Line3d& line : features.lines.lines_3d()) visit(extent_of(line));
}

// Sums of the evidence of features, in m.
struct EvidenceSum {
  double all = 0, proven = 0;

  // Not inlined: called at several places.
  [[gnu::noinline]] void add(const Coverage& coverage, const Extent& extent) {
    const double evidence = coverage.evidence(extent);
    all += evidence;
    if (extent.record.proven()) proven += evidence;
  }
};

// What the motion from the base explains of the view of all references. Not inlined: the cells would
// otherwise stay on the stack during the search.
[[gnu::noinline]] Explained explained_by(const Se3& T_current_base, std::span<const Reference> references,
                                         const ReferenceTracking& tracking, const CameraModel& camera) {
  Coverage coverage;
  EvidenceSum view, found;
  for (std::size_t r = 0; r < references.size(); ++r) {
    const FrameFeatures& features = *references[r].features;
    const ReferenceTracks& tracks = tracking.tracks(r);
    const Se3 T_current_reference = T_current_base * references[r].pose.T_reference_base.inverse();
    coverage.clear();
    for (const bool are_counted : {false, true})
      for_each_extent(features, [&](const Extent& extent) {
        const Vector3 here = T_current_reference * extent.middle;
        if (!(here.z() > kNearestSeen_m)) return;
        const Vector2 at = project(camera.pinhole, here);
        if (!(at.x() >= 0 && at.y() >= 0 && at.x() <= camera.width - 1 && at.y() <= camera.height - 1))
          return;
        if (are_counted)
          view.add(coverage, extent);
        else
          coverage.count(extent);
      });
    for (std::size_t i = 0; i < tracks.points.matches.size(); ++i)
      if (tracks.point_inliers[i] != 0)
        found.add(coverage, extent_of(features.points.points[tracks.points.matches[i].reference]));
    for (std::size_t i = 0; i < tracks.lines.size(); ++i)
      if (tracks.line_inliers[i] != 0)
        found.add(coverage, extent_of(features.lines.lines_3d()[tracks.lines[i].reference]));
  }
  Explained explained;
  explained.evidence = found.all;
  if (view.all > 0) explained.share = found.all / view.all;
  explained.explains_proven = view.proven < kFewProven * view.all ||
                              found.proven >= kLeastOfProven * view.proven ||
                              found.proven >= kLeastOfProven * found.all;
  return explained;
}

// Mean distance, in the plane z = 1, between the positions that two motions give the features of a
// reference.
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

class MotionSearch {
 public:
  // All must outlive this object. tracked: what the last estimate found.
  MotionSearch(const CurrentFrame& current, ReferenceTracking& tracking, TrackedMotion& tracked)
      : current_(current),
        scope_(current.context.scratch),
        tracking_(tracking),
        tracked_(tracked),
        references_(current.predicted.references),
        latest_(references_[latest_of(references_)]) {}

  // Tries the motion that aligns the images. Returns whether it is accepted.
  bool from_image() {
    Se3 aligned;
    if (!is_registered() || !tracking_.align(latest_, current_, aligned)) return false;
    const Se3 by_prediction = latest_.T_current_predicted * latest_.pose.T_reference_base;
    Se3 start = aligned * latest_.pose.T_reference_base;
    const bool are_apart =
        distance_between(aligned, latest_.T_current_predicted, *latest_.features) > kSameStart;
    Se3 rival = start;
    const bool has_rival = are_apart && choose_start(by_prediction, start, rival);
    const Explained found = explain(start);
    if (has_rival && tracked_.ok() && is_other_motion(rival, tracked_.motion.T_current_reference))
      tracked_.motion.contain(boxminus(rival, tracked_.motion.T_current_reference));
    if (found.share < kAcceptedShareByImage || !found.explains_proven) return false;
    // An object may cover most of the image. The search is therefore repeated from the prediction,
    // which may lead to another motion although it is near.
    if (!are_apart && (tracked_.motion.explained < kWorldAtRest || tracked_.motion.contradicted)) {
      explain(by_prediction, 1 / kComparableShare);
      take_best();
    }
    return true;
  }

  // Tries motions that features give, first near the prediction, then over a wide area.
  void from_features() {
    current_.describe_points();
    const Reference& nearest = is_findable(latest_) ? latest_ : references_[0];
    bool accepted = find(nearest, nearest.T_current_predicted, PointMatchConfig().radius_px);
    for (std::size_t r = references_.size(); r-- > 0 && !accepted;) {
      const Reference& reference = references_[r];
      if (!is_findable(reference)) continue;
      accepted = find(reference, current_.predicted.sensed.known() ? reference.T_current_predicted : Se3{},
                      kWideSearch_px);
    }
    if (accepted) return;
    take_best();
    if (!best_.explained.explains_proven) tracked_.motion.status = StatusCode::kNoConsensus;
  }

 private:
  bool is_registered() const { return current_.context.config.points.registered; }

  bool is_other_motion(const Se3& a, const Se3& b) const {
    const Se3 T_base_latest = latest_.pose.T_reference_base.inverse();
    return distance_between(a * T_base_latest, b * T_base_latest, *latest_.features) > kOtherMotion;
  }

  Explained explained_by_tracked() const {
    Explained explained =
        explained_by(tracked_.motion.T_current_reference, references_, tracking_, current_.context.camera);
    if (tracked_.motion.contradicted) explained.evidence *= kWorthOfContradicted;
    return explained;
  }

  bool refine(Se3 T_current_base) {
    for (int i = 1; i <= kMostRegistrations; ++i) {
      tracking_.refine(references_, current_, T_current_base, i < kMostRegistrations, tracked_);
      if (!tracked_.ok() || !tracked_.motion.is_other) break;
      T_current_base = tracked_.motion.T_current_reference;
    }
    return tracked_.ok();
  }

  // times: the motion becomes the best one if it explains more than this many times what the best
  // one so far explains.
  Explained explain(const Se3& start, double times = 1) {
    keep_best();
    Explained explained;
    if (refine(start)) explained = explained_by_tracked();
    if (!explained.explains_proven) explained.evidence *= kWorthOfContradicted;
    last_is_best_ = explained.evidence > times * best_.explained.evidence;
    if (last_is_best_) best_ = {start, tracked_.motion.T_current_reference, explained};
    return explained;
  }

  Explained glance(const Se3& start) {
    tracking_.glance(references_, current_, start, tracked_);
    return tracked_.ok() ? explained_by_tracked() : Explained{};
  }

  // Before the next estimate: keeps the last one if it is the best so far.
  void keep_best() {
    if (!last_is_best_) return;
    tracking_.keep(tracked_, current_.context.scratch, kept_);
    last_is_best_ = false;
  }

  // If the lines of the frame were lifted again, the best motion is estimated again, with lines for it.
  void take_best() {
    if (last_is_best_ || !(best_.explained.evidence > 0)) return;
    if (current_.features.lines.lifts > 1)
      (void)refine(best_.start);
    else
      tracking_.put_back(*kept_, tracked_);
    last_is_best_ = true;
  }

  // Glances at the aligned motion, which is `start`, and at the predicted one. Writes the one to start from
  // to `start` and the other one to `rival`. Returns whether they are different motions that explain about
  // the same.
  bool choose_start(const Se3& by_prediction, Se3& start, Se3& rival) {
    const Explained by_image = glance(start);
    const bool image_leads = tracked_.ok();
    if (image_leads) start = tracked_.motion.T_current_reference;
    const Explained predicted = glance(by_prediction);
    if (!tracked_.ok()) return false;
    rival = tracked_.motion.T_current_reference;
    const bool is_other = !image_leads || is_other_motion(start, rival);
    const double least = is_other ? kComparableShare : 1 / kComparableShare;
    if (predicted.evidence > least * by_image.evidence) std::swap(start, rival);
    return is_other && are_comparable(predicted.evidence, by_image.evidence);
  }

  // Tries the motion that the descriptors of one reference give. Returns whether it is accepted.
  bool find(const Reference& from, const Se3& T_predicted, double radius_px) {
    keep_best();
    tracking_.find(from, current_, T_predicted, radius_px, tracked_);
    if (!tracked_.ok()) return false;
    if (!is_registered()) return true;
    const Se3 start = tracked_.motion.T_current_reference * from.pose.T_reference_base;
    // A motion is also accepted if two searches lead to it.
    if (best_.explained.evidence > 0 && !is_other_motion(start, best_.motion)) {
      take_best();
      return tracked_.ok() && best_.explained.explains_proven;
    }
    const Explained found = explain(start);
    return found.share >= kAcceptedShareByFeatures && found.explains_proven;
  }

  const CurrentFrame& current_;
  ScratchScope scope_;
  ReferenceTracking& tracking_;
  TrackedMotion& tracked_;
  std::span<const Reference> references_;
  const Reference& latest_;
  // The motion that explains most so far, the start that led to it, and what it explains.
  struct {
    Se3 start, motion;
    Explained explained;
  } best_;
  bool last_is_best_ = false;  // the last estimate is that of best_; otherwise it is kept
  KeptEstimate* kept_ = nullptr;
};

}  // namespace

// Not inlined: its variables are on the stack only during the search.
[[gnu::noinline]] void search_motion(const CurrentFrame& current, ReferenceTracking& tracking,
                                     TrackedMotion& tracked) {
  MotionSearch search(current, tracking, tracked);
  if (!search.from_image()) search.from_features();
}

}  // namespace plvo
