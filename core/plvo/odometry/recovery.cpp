// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/recovery.hpp"

#include <algorithm>

#include "plvo/math/mahalanobis.hpp"

namespace plvo {
namespace {

// Not inlined: its matrices would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] bool agree(const PoseWithCovariance& reference, const MotionEstimate& motion,
                             const PoseWithCovariance& b) {
  const PoseWithCovariance a = advance(reference, motion.T_current_reference, motion.C_H);
  const Vector6 apart = boxminus(a.T_world_camera, b.T_world_camera);
  return mahalanobis_squared<6>(apart, a.covariance + b.covariance) <= kMostPlausibleMotion;
}

}  // namespace

bool still_seen(const FrameFeatures& reference, const ReferenceTracks& tracks, double share) {
  std::size_t available = reference.lines.count_3d;
  for (const Point3d& point : reference.points.points.first(reference.points.keypoints.size()))
    available += point.p.z() > 0 ? 1 : 0;
  return tracks.inliers >= share * static_cast<double>(available);
}

bool recognise(const Window::Frame& keyframe, const CurrentFrame& frame, const Vector6& velocity,
               const PoseWithCovariance& believed, ReferenceTracking& tracking, TrackedMotion& tracked) {
  const StageContext& context = frame.context;
  Reference kept;
  kept.features = &keyframe.features;
  kept.timing.recent = velocity;
  kept.timing.reference = keyframe.velocity;
  kept.timing.reference_is_last = false;
  kept.timing.depth_after_colour_s = frame.predicted.depth_after_colour_s;
  kept.chained = false;
  frame.describe_points();
  const double anywhere_px = std::max(context.camera.width, context.camera.height);
  tracking.find(kept, frame, Se3{}, anywhere_px, tracked);
  if (tracked.ok() && context.config.points.registered) {
    const Se3 T_current_reference = tracked.motion.T_current_reference;
    tracking.refine({&kept, 1}, frame, T_current_reference, false, tracked);
  }
  return tracked.ok() &&
         still_seen(keyframe.features, tracking.tracks(0), context.config.references.keyframe_inlier_ratio) &&
         agree(keyframe.pose, tracked.motion, believed);
}

}  // namespace plvo
