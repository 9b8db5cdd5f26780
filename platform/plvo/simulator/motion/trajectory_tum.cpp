// SPDX-License-Identifier: Apache-2.0
// Moves the simulated camera along a recorded TUM trajectory.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/simulator/motion/trajectory.hpp"

namespace plvo::sim {
namespace {

constexpr double kStep_s = 0.01;       // motion capture runs at 100 Hz
constexpr double kSmoothing_s = 0.02;  // standard deviation of the Gaussian that removes the 0.1 mm steps
constexpr int kSmoothingReach = 6;     // steps to each side
constexpr std::int64_t kLongest_ns = 3'600'000'000'000;

Status read_samples(const std::string& path, std::vector<StampedPose>& samples) {
  plvo::Trajectory recording;
  if (Status status = read_trajectory({path, TrajectoryFormat::kTum, {}}, recording); !status.ok())
    return status;
  samples = std::move(recording.poses);
  const auto damaged = [&path](const char* what) {
    return Status(StatusCode::kDamaged, path.substr(0, 160)).append(what);
  };
  if (recording.ignored_rows > 0) return damaged(" has rows with a NaN or a repeated stamp");
  if (samples.size() < 2) return damaged(" holds fewer than two poses");
  if (samples.back().stamp_ns - samples.front().stamp_ns > kLongest_ns)
    return damaged(" is longer than an hour");
  return {};
}

// Resamples to evenly spaced poses; gaps are interpolated at constant velocity.
std::vector<Se3> resample(const std::vector<StampedPose>& samples) {
  std::vector<Se3> poses;
  const auto since_start_s = [&samples](std::size_t k) {
    return static_cast<double>(samples[k].stamp_ns - samples.front().stamp_ns) * 1e-9;
  };
  const auto count = static_cast<std::size_t>(since_start_s(samples.size() - 1) / kStep_s + 1e-6) + 1;
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double t_s = static_cast<double>(i) * kStep_s;
    while (k + 2 < samples.size() && since_start_s(k + 1) <= t_s) ++k;
    const double u = (t_s - since_start_s(k)) / (since_start_s(k + 1) - since_start_s(k));
    poses.push_back(boxplus(samples[k].T_world_camera,
                            u * boxminus(samples[k + 1].T_world_camera, samples[k].T_world_camera)));
  }
  return poses;
}

std::vector<Se3> smooth(const std::vector<Se3>& poses) {
  std::vector<Se3> smoothed;
  const auto n = static_cast<int>(poses.size());
  for (int i = 0; i < n; ++i) {
    const Se3& centre = poses[static_cast<std::size_t>(i)];
    Vector6 sum = Vector6::Zero();
    double weights = 0;
    // A symmetric window does not pull the ends inwards.
    const int reach = std::min({kSmoothingReach, i, n - 1 - i});
    for (int k = -reach; k <= reach; ++k) {
      const double x = k * kStep_s / kSmoothing_s;
      const double w = plvo::exp(-0.5 * x * x);
      sum += w * boxminus(poses[static_cast<std::size_t>(i + k)], centre);
      weights += w;
    }
    smoothed.push_back(boxplus(centre, sum / weights));
  }
  return smoothed;
}

double heading(const Matrix3& R) { return plvo::atan2(R(1, 2), R(0, 2)); }

}  // namespace

Status Trajectory::from_tum(const std::string& path, const Scene& scene, Trajectory& trajectory) {
  std::vector<StampedPose> samples;
  const Status read = read_samples(path, samples);
  if (!read.ok()) return read;
  std::vector<Se3> poses = smooth(resample(samples));
  if (poses.size() < 2)
    return Status(StatusCode::kDamaged, path.substr(0, 160)).append(" is shorter than 20 ms");

  // Rotates about the vertical so that the first view has the heading of the scene's stroll.
  const PathPoint& begin = scene.stroll.front();
  const double turn = static_cast<double>(begin.yaw) - heading(poses.front().R);
  const Matrix3 R_scene_recording = rotation_exp(Vector3(0, 0, turn));
  const Vector3 origin = poses.front().t;
  Vector3 lo = Vector3::Zero();
  Vector3 hi = Vector3::Zero();
  for (Se3& pose : poses) {
    pose = {R_scene_recording * pose.R, R_scene_recording * (pose.t - origin)};
    lo = lo.cwiseMin(pose.t);
    hi = hi.cwiseMax(pose.t);
  }
  double scale = 1;
  Vector3 start;
  for (int axis = 0; axis < 3; ++axis) {
    const double room = static_cast<double>(scene.free_hi[axis]) - static_cast<double>(scene.free_lo[axis]);
    if (hi(axis) - lo(axis) > 0) scale = std::min(scale, room / (hi(axis) - lo(axis)));
  }
  for (int axis = 0; axis < 3; ++axis)
    start(axis) = std::clamp(static_cast<double>(begin.position[axis]),
                             static_cast<double>(scene.free_lo[axis]) - scale * lo(axis),
                             std::max(static_cast<double>(scene.free_lo[axis]) - scale * lo(axis),
                                      static_cast<double>(scene.free_hi[axis]) - scale * hi(axis)));
  for (Se3& pose : poses) pose.t = start + scale * pose.t;

  trajectory = {};
  trajectory.scale_ = scale;
  trajectory.step_s_ = kStep_s;
  trajectory.duration_s_ = kStep_s * static_cast<double>(poses.size() - 1);
  trajectory.poses_ = std::move(poses);
  return {};
}

}  // namespace plvo::sim
