// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/loop_check.hpp"

#include <algorithm>

namespace plvo {
namespace {

// Standard deviation of a detected keypoint between views that differ, in pixels of its level.
constexpr double kDetectedSigma_px = 1;
// A loop needs at least this many inliers, points and lines, and this share of the point matches as inliers.
// Between desks of other rooms that look alike, less than half of the point matches agree.
constexpr int kLeastLoopInliers = 20;
constexpr double kLeastLoopShare = 0.5;
// Bounds on the standard deviations of the motion in its worst direction.
constexpr double kMostLoopSigma_m = 0.05, kMostLoopSigma_rad = 0.05;
// The motion of the points alone only has to lead to the lines: fewer inliers suffice, and it may be less
// certain. A few points in a wide room fix it to a tenth of a metre; with the lines, to a centimetre.
constexpr int kLeastFirstInliers = 12;
constexpr double kMostFirstSigma_m = 0.2, kMostFirstSigma_rad = 0.2;

constexpr LmOptions kLoopSolve{.max_iterations = 20, .decrease_tolerance = 2e-2};

// The settings with these bounds, where they are not stricter already.
MotionConfig bounded(MotionConfig motion, int least_inliers, double most_sigma_m, double most_sigma_rad) {
  motion.min_inliers = std::max(motion.min_inliers, least_inliers);
  motion.max_sigma_m = std::min(motion.max_sigma_m, most_sigma_m);
  motion.max_sigma_rad = std::min(motion.max_sigma_rad, most_sigma_rad);
  return motion;
}

void unpack_points(const MapFeatures& view, const Pinhole& pinhole, PointFeatures& out) {
  out.keypoints.clear();
  for (const MapPoint& point : view.points) {
    out.points[out.keypoints.size()] = unpack(point, pinhole, kDetectedSigma_px);
    Keypoint keypoint;
    keypoint.u = point.u;
    keypoint.v = point.v;
    keypoint.level = point.level;
    out.keypoints.push_back(keypoint);
  }
  out.descriptors = view.descriptors;
}

}  // namespace

LoopCheck::LoopCheck(const CameraModel& of_camera, const Config& config)
    : camera(of_camera),
      first_motion(bounded(config.motion, kLeastFirstInliers, kMostFirstSigma_m, kMostFirstSigma_rad)),
      motion(bounded(config.motion, kLeastLoopInliers, kMostLoopSigma_m, kMostLoopSigma_rad)),
      point_correlation(config.noise.point_correlation),
      line_correlation(config.noise.line_correlation),
      seed(config.seed) {}

// Points are searched where the motion puts them; without one, in the whole image.
void LoopCheck::match_points_of(const Se3* T_predicted, Views& views, Arena& scratch) const {
  const std::size_t n_old = views.old_points.keypoints.size();
  PointMatchConfig config;
  if (T_predicted == nullptr) config.radius_px = camera.width + camera.height;
  for (std::size_t i = 0; i < n_old; ++i) {
    Prediction& prediction = views.predictions[i] = {0, 0, true};
    if (T_predicted == nullptr) continue;
    const Vector3 here = *T_predicted * views.old_points.points[i].p;
    prediction.visible = here.z() > kNearestSeen_m;
    if (!prediction.visible) continue;
    const Vector2 at = project(camera.pinhole, here);
    prediction.u = static_cast<float>(at.x());
    prediction.v = static_cast<float>(at.y());
  }
  match_points(views.old_points, views.predictions.first(n_old), views.new_points, camera.width,
               camera.height, config, scratch, views.point_matches);
}

void LoopCheck::match_lines_after(const Se3& T_new_old, const MapFeatures& old_view,
                                  const MapFeatures& new_view, Views& views, Arena& scratch) const {
  const std::size_t n_old = old_view.lines.size(), n_new = new_view.lines.size();
  for (std::size_t i = 0; i < n_old; ++i) {
    const Line3d& line = views.old_lines[i] = unpack(old_view.lines[i]);
    views.predicted[i] = project_line(camera.pinhole, T_new_old * line.a, T_new_old * line.b);
  }
  for (std::size_t i = 0; i < n_new; ++i) {
    const Line3d& line = views.new_lines[i] = unpack(new_view.lines[i]);
    views.found[i] = project_line(camera.pinhole, line.a, line.b);
  }
  match_lines(views.predicted.first(n_old), old_view.line_descriptors, views.found.first(n_new),
              new_view.line_descriptors, LineMatchConfig::guided(), scratch, views.line_matches);
}

LoopMeasurement LoopCheck::operator()(const MapFeatures& old_view, const MapFeatures& new_view,
                                      Arena& scratch, const Se3* T_predicted) const {
  LoopMeasurement loop;
  const ScratchScope scope(scratch);
  const std::size_t most_points = std::max(old_view.points.size(), new_view.points.size());
  const std::size_t most_lines = std::max(old_view.lines.size(), new_view.lines.size());
  Views views = take_views(scratch, most_points, most_lines);
  if (scratch.exhausted()) return loop;
  unpack_points(old_view, camera.pinhole, views.old_points);
  unpack_points(new_view, camera.pinhole, views.new_points);
  match_points_of(T_predicted, views, scratch);

  // The first estimate is from points alone. Lines are matched where its motion puts them, and join the
  // second estimate.
  Se3 T_new_old;
  if (T_predicted != nullptr) T_new_old = *T_predicted;
  for (const bool with_lines : {false, true}) {
    if (!with_lines && T_predicted != nullptr) continue;
    if (with_lines) match_lines_after(T_new_old, old_view, new_view, views, scratch);
    const ScratchScope estimating(scratch);
    PointConstraints points(views.old_points.points, views.new_points.points, views.point_matches.span(),
                            PointConstraints::Workspace::take(scratch, views.point_matches.size()));
    LineConstraints lines(views.old_lines, views.new_lines, views.line_matches.span(),
                          LineConstraints::Workspace::take(scratch, views.line_matches.size()));
    points.set_reference(0, point_correlation);
    lines.set_reference(0, line_correlation);
    const std::array<ConstraintSet*, 2> sets{&points, &lines};
    MotionStart start(with_lines ? &T_new_old : nullptr, NuisanceParameters(), with_lines);
    start.find_shifts = false;
    const std::span<MotionEstimate> estimate = take_estimate(scratch);
    if (estimate.empty()) return loop;
    estimate_motion(sets, {}, MotionReferences(), with_lines ? motion : first_motion, kLoopSolve, seed, start,
                    scratch, estimate[0]);
    if (estimate[0].status != StatusCode::kOk ||
        estimate[0].inliers[0] < kLeastLoopShare * static_cast<double>(points.size()))
      return loop;
    T_new_old = estimate[0].T_current_reference;
    if (!with_lines) continue;
    loop.found = true;
    loop.T_old_new = T_new_old.inverse();
    loop.covariance = inverse_covariance(T_new_old, estimate[0].C_H);
    loop.inliers = estimate[0].inliers[0] + estimate[0].inliers[1];
  }
  return loop;
}

}  // namespace plvo
