// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/scene_recorder.hpp"

#include <cmath>

namespace plvo::report {
namespace {

// Drops every second entry of a full list.
template <typename T>
void keep_within(std::vector<T>& list, std::size_t most, std::size_t& step) {
  if (list.size() <= most) return;
  for (std::size_t i = 0; 2 * i < list.size(); ++i) list[i] = list[2 * i];
  list.resize((list.size() + 1) / 2);
  step *= 2;
}

bool certain(const Matrix3& covariance) {
  return covariance.trace() < SceneRecorder::kMostSigma_m * SceneRecorder::kMostSigma_m;
}

}  // namespace

void SceneRecorder::offer(const Odometry& odometry) {
  const KeyframeView keyframe = odometry.keyframe();
  if (keyframe.features == nullptr || (any_ && keyframe.features->stamp_ns == keyframe_stamp_ns_)) return;
  any_ = true;
  keyframe_stamp_ns_ = keyframe.features->stamp_ns;
  const Se3& T = keyframe.T_world_camera;
  const PointFeatures& points = keyframe.features->points;
  for (std::size_t i = 0; i < points.keypoints.size(); i += point_step_)
    if (certain(points.points[i].Sigma)) scene_.points.push_back(T * points.points[i].p);
  const std::span<const Line3d> lines = keyframe.features->lines.lines_3d();
  for (std::size_t i = 0; i < lines.size(); i += line_step_)
    if (certain(lines[i].Sigma.topLeftCorner<3, 3>()) && certain(lines[i].Sigma.bottomRightCorner<3, 3>()))
      scene_.lines.emplace_back(T * lines[i].a, T * lines[i].b);
  keep_within(scene_.points, kMostPoints, point_step_);
  keep_within(scene_.lines, kMostLines, line_step_);
}

}  // namespace plvo::report
