// SPDX-License-Identifier: Apache-2.0
// Where the odometry expects the camera, and how it looks for the motion from there: which frames a new one
// is matched with, what is known beforehand, and what is tried in which order.
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// Beyond so many times the last motion's own time a prediction is worse than none.
constexpr int kLongestPrediction = 3;

// A first motion is_accepted where at least this share is found of what it puts into the image. An image that
// is aligned where it does not belong mostly finds less than a tenth; a search by features, before a wall
// that repeats itself and a brick off, a fifth. So does a right one in a blurred image: it is not refused,
// but others are looked for as well.
constexpr double kAcceptedShareByImage = 0.1;
constexpr double kAcceptedShareByFeatures = 0.2;
// Or two ways lead to the same motion: within this distance (m and rad).
constexpr double kSameMotion = 0.02;

}  // namespace

// How the camera moves while the frame is exposed, if it goes on as it did.
Exposure Odometry::predict_exposure(std::int64_t stamp_ns) const {
  if (!window_.has_last()) return {};
  const PairPrior prior = prior_of(window_.last(), stamp_ns);
  return current_exposure(camera(), prior, prior.T_current_reference);
}

// The motion from the reference to now: as other sensors tell it, or if the camera goes on as it did between
// the last two good frames.
Se3 Odometry::predict_motion(int reference, std::int64_t stamp_ns) const {
  const Window::Frame& last = window_.last_frame();
  const Se3 T_last_reference = last.pose.T_world_camera.inverse() * window_[reference].pose.T_world_camera;
  if (propagated_prior_.known()) return propagated_prior_.T_current_last() * T_last_reference;
  const auto elapsed = static_cast<double>(elapsed_ns(last.features.stamp_ns, stamp_ns));
  if (!(elapsed < kLongestPrediction * static_cast<double>(last.motion_ns))) return T_last_reference;
  return boxplus(Se3{}, elapsed * 1e-9 * last.velocity) * T_last_reference;
}

PairPrior Odometry::prior_of(int reference, std::int64_t stamp_ns) const {
  const Window::Frame& from = window_[reference];
  const Window::Frame& last = window_.last_frame();
  PairPrior prior;
  prior.T_current_reference = predict_motion(reference, stamp_ns);
  prior.T_reference_last = from.pose.T_world_camera.inverse() * last.pose.T_world_camera;
  prior.seconds_since_last = static_cast<double>(elapsed_ns(last.features.stamp_ns, stamp_ns)) * 1e-9;
  prior.reference_velocity = from.velocity;
  prior.reference_velocity_known = from.motion_ns > 0;
  prior.reference_is_last = reference == window_.last();
  prior.last_velocity = last.velocity;
  prior.last_velocity_known = last.motion_ns > 0;
  prior.depth_after_colour_s = depth_after_colour_s_;
  return prior;
}

// The keyframe, which is the base, a recent frame, and the keyframe before, as far as the policy wants them.
// Apart: what it makes them of is not on the stack while the motion is looked for.
[[gnu::noinline]] std::size_t Odometry::list_references(std::int64_t stamp_ns, References& references) const {
  std::size_t count = 0;
  const auto add = [&](int slot) {
    references[count++] = {.features = &window_[slot].features,
                           .prior = prior_of(slot, stamp_ns),
                           .pose = window_.from_keyframe(slot)};
  };
  add(window_.keyframe());
  if (window_.has_recent()) add(window_.recent());
  if (window_.has_older()) add(window_.older());
  return count;
}

// A first motion from the latest reference, by its image; failing that by features: where they are predicted,
// or from each reference, wherever they may be, unless other sensors say where. Each leads to the motion from
// all references. The first that is_accepted is taken, else the one that most agree with. The keyframe's
// points are described, and those of the keyframe before, not a recent frame's.
[[gnu::noinline]] void Odometry::estimate_motion(const DepthSampler& depth, TrackedMotion& tracked,
                                                 TrackResult& result) {
  References references;
  const std::size_t count = list_references(result.stamp_ns, references);
  const MotionReference last = window_.from_keyframe(window_.last());
  const CurrentFrame current{
      window_.current_frame().features, memory_.extraction, depth, noise_, propagated_prior_, last};
  result.reference_stamp_ns = window_[window_.keyframe()].features.stamp_ns;
  const std::span<const Reference> all = std::span(references).first(count);
  const Reference& latest = all[latest_of(all)];
  const bool registered = config().points.registered;
  const auto refine = [&](const Se3& T_current_base) {
    memory_.tracking.refine(all, current, T_current_base, arena_, tracked, result);
    return tracked.motion.status == StatusCode::kOk;
  };
  // Of the motions that did not convince: where it led to, from where, and how many agree with it.
  struct {
    Se3 motion, start;
    int inliers = 0;
  } best;
  bool last_is_best = false;  // nothing was tried since
  const auto is_accepted = [&](const Se3& start, double share) {
    const Se3& motion = tracked.motion.T_current_reference;
    const int inliers = result.points.inliers + result.lines.inliers;
    if (is_share_of_view(inliers, share, all, camera(), motion)) return true;
    last_is_best = inliers > best.inliers;
    if (last_is_best) best = {motion, start, inliers};
    return false;
  };
  if (Se3 start; registered && memory_.tracking.align(latest, current, arena_, start, result)) {
    start = start * latest.pose.T_reference_base;
    if (refine(start) && is_accepted(start, kAcceptedShareByImage)) return;
  }

  find_points(depth, result);
  describe_points(result);
  const auto findable = [](const Reference& from) {
    const PointFeatures& points = from.features->points;
    return points.described || points.keypoints.empty();
  };
  const auto find = [&](const Reference& from, double radius_px) {
    last_is_best = false;
    memory_.tracking.find(from, current, radius_px, arena_, tracked, result);
    if (tracked.motion.status != StatusCode::kOk) return false;
    if (!registered) return true;
    const Se3 start = tracked.motion.T_current_reference * from.pose.T_reference_base;
    if (best.inliers > 0 && boxminus(start, best.motion).norm() < kSameMotion) return refine(best.start);
    return refine(start) && is_accepted(start, kAcceptedShareByFeatures);
  };
  if (find(findable(latest) ? latest : all[0], config().points.match.radius_px)) return;
  for (std::size_t r = count; r-- > 0;) {
    if (!findable(references[r])) continue;
    if (!propagated_prior_.known()) references[r].prior.T_current_reference = Se3{};
    if (find(references[r], config().references.wide_search_px)) return;
  }
  if (best.inliers > 0 && !last_is_best) (void)refine(best.start);
}

}  // namespace plvo
