// SPDX-License-Identifier: Apache-2.0
// Predicts the pose of the camera and searches for the motion from there: which frames are matched with the
// current one, what is known beforehand, and which searches are tried in which order.
#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo {
namespace {

// A prediction over more than this multiple of the last motion's duration is worse than none.
constexpr int kLongestPrediction = 3;

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

}  // namespace

// Motion of the camera during the exposure of the frame, if it goes on as before.
Exposure Odometry::predict_exposure(std::int64_t stamp_ns) const {
  if (!window_.has_last()) return {};
  const PairPrior prior = prior_of(window_.last(), stamp_ns);
  return current_exposure(camera(), prior, prior.T_current_reference);
}

// Motion from the reference to the current frame: from other sensors, or else by constant velocity from the
// last two good frames.
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

// Lists the keyframe, which is the base, a recent frame, and the previous keyframe, as the policy requires.
// Not inlined: its temporaries are not on the stack during the search for the motion.
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

// Searches for a first motion from the latest reference by image alignment. If that fails, searches by
// features: first near the prediction, then from each reference over a wide area, around the propagated prior
// if there is one. Each first motion is refined with all references. The first that is_accepted() is taken,
// else the one with most inliers. The points of both keyframes are described, those of a recent frame are
// not.
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
  // The best of the motions that were not accepted: its result, its start, and its number of inliers.
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
  if (find(findable(latest) ? latest : all[0], PointMatchConfig().radius_px)) return;
  for (std::size_t r = count; r-- > 0;) {
    if (!findable(references[r])) continue;
    if (!propagated_prior_.known()) references[r].prior.T_current_reference = Se3{};
    if (find(references[r], kWideSearch_px)) return;
  }
  if (best.inliers > 0 && !last_is_best) (void)refine(best.start);
}

}  // namespace plvo
