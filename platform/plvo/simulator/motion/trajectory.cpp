// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/motion/trajectory.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "plvo/base/random.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

// Rotation of an optical frame (x right, y down, z forward) with this heading and pitch in a world with z up.
Matrix3 look(double yaw, double pitch) {
  const Vector3 forward(cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), sin(pitch));
  const Vector3 right(sin(yaw), -cos(yaw), 0);
  const Vector3 down = forward.cross(right);
  Matrix3 R;
  R.col(0) = right;
  R.col(1) = down;
  R.col(2) = forward;
  return R;
}

struct SplinePoint {
  Vector3 position;
  double yaw = 0, pitch = 0;
};

// Evaluates the closed uniform cubic B-spline at phase ∈ [0, 1). With winding, the heading grows by 2π per
// lap.
SplinePoint spline_at(const std::vector<PathPoint>& points, double phase, bool winding) {
  const auto n = static_cast<int>(points.size());
  const double x = phase * n;
  const int k = std::min(static_cast<int>(x), n - 1);
  const double u = x - k;
  const std::array<double, 4> weights = {(1 - u) * (1 - u) * (1 - u) / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                                         (-3 * u * u * u + 3 * u * u + 3 * u + 1) / 6, u * u * u / 6};
  SplinePoint sum;
  sum.position.setZero();
  for (int i = 0; i < 4; ++i) {
    const int index = k + i - 1;
    const int wrapped = (index + n) % n;
    const PathPoint& p = points[static_cast<std::size_t>(wrapped)];
    const double laps = winding ? (index < 0 ? -1 : (index >= n ? 1 : 0)) : 0;
    const double w = weights[static_cast<std::size_t>(i)];
    sum.position += w * Vector3(static_cast<double>(p.position.x), static_cast<double>(p.position.y),
                                static_cast<double>(p.position.z));
    sum.yaw += w * (static_cast<double>(p.yaw) + 2 * kPi * laps);
    sum.pitch += w * static_cast<double>(p.pitch);
  }
  return sum;
}

double spline_length(const std::vector<PathPoint>& points, bool winding) {
  constexpr int kSteps = 400;
  double length = 0;
  for (int i = 0; i < kSteps; ++i)
    length += (spline_at(points, (i + 1) % kSteps / static_cast<double>(kSteps), winding).position -
               spline_at(points, i / static_cast<double>(kSteps), winding).position)
                  .norm();
  return length;
}

}  // namespace

Trajectory Trajectory::hand_held(const Scene& scene, std::uint64_t seed, double duration_s) {
  Trajectory generated;
  generated.duration_s_ = duration_s;
  const double reach_m = duration_s * static_cast<double>(scene.speed_mps);
  const double round_m = scene.round.empty() ? 0 : spline_length(scene.round, true);
  if (round_m > 0 && reach_m > 0.8 * round_m) {
    generated.points_ = scene.round;
    generated.winding_ = true;
    generated.rounds_ = std::max(1, static_cast<int>(reach_m / round_m + 0.5));
  } else {
    generated.points_ = scene.stroll;
    const double stroll_m = spline_length(scene.stroll, false);
    generated.rounds_ = std::max(1, static_cast<int>(reach_m / stroll_m + 0.5));
    generated.extent_ = std::min(1.0, reach_m / stroll_m);
  }

  // Amplitudes per frequency band: translations x y z (m), rotations pitch yaw roll (rad). Each band's
  // frequency is drawn from the seed, then rounded to a whole number of periods.
  Random random(seed, 0x5452);
  constexpr std::array<double, kWaves> kBand_hz = {0.3, 0.7, 1.6, 3.1, 5.7};
  constexpr std::array<std::array<double, kWaves>, 6> kAmplitude = {{
      {0.020, 0.012, 0.003, 0.0008, 0.0002},  // sideways: one period per two steps
      {0.010, 0.004, 0.009, 0.0010, 0.0002},  // vertical: one period per step
      {0.015, 0.006, 0.003, 0.0008, 0.0002},
      {0.020, 0.009, 0.005, 0.0018, 0.0006},
      {0.026, 0.012, 0.004, 0.0018, 0.0006},
      {0.014, 0.009, 0.004, 0.0015, 0.0005},
  }};
  for (std::size_t dof = 0; dof < 6; ++dof) {
    for (std::size_t k = 0; k < kWaves; ++k) {
      Wave& wave = generated.waves_[dof][k];
      const double periods = kBand_hz[k] * (0.8 + 0.4 * random.uniform()) * duration_s;
      wave.periods = static_cast<int>(periods + 0.5);
      // A band too slow for a short trajectory is omitted, not sped up.
      wave.amplitude = wave.periods == 0 ? 0 : kAmplitude[dof][k] * (0.7 + 0.6 * random.uniform());
      wave.phase_rad = 2 * kPi * random.uniform();
    }
  }
  return generated;
}

Se3 Trajectory::generated_at(double t_s) const {
  double phase = duration_s_ > 0 ? t_s / duration_s_ : 0;
  phase -= std::floor(phase);
  double lap = phase * rounds_;
  lap -= std::floor(lap);
  const SplinePoint start = spline_at(points_, 0, winding_);
  const SplinePoint now = spline_at(points_, lap, winding_);
  Vector6 sway;
  for (int dof = 0; dof < 6; ++dof) {
    double sum = 0;
    for (const Wave& wave : waves_[static_cast<std::size_t>(dof)])
      sum += wave.amplitude * sin(2 * kPi * wave.periods * phase + wave.phase_rad);
    sway(dof) = sum;
  }
  Se3 T_world_body;
  T_world_body.t = start.position + (now.position - start.position) * extent_;
  const double pitch = start.pitch + (now.pitch - start.pitch) * extent_;
  T_world_body.R = look(start.yaw + (now.yaw - start.yaw) * extent_, on_robot_ ? 0 : pitch);
  if (on_robot_) T_world_body.t.z() = start.position.z();
  const Vector3 turn(sway(3), sway(4), sway(5));
  const Se3 T_body_camera{rotation_exp(turn), Vector3(sway(0), sway(1), sway(2))};
  return T_world_body * T_body_camera;
}

void Trajectory::put_on_robot() {
  on_robot_ = true;
  constexpr std::size_t kFirstRumble = 3;  // of the bands: 3 Hz and more
  constexpr std::array<bool, 6> kRumbles = {false, true, false, true, false, true};  // height, pitch, roll
  for (std::size_t dof = 0; dof < 6; ++dof)
    for (std::size_t k = 0; k < kWaves; ++k)
      if (!kRumbles[dof] || k < kFirstRumble) waves_[dof][k].amplitude = 0;
}

Se3 Trajectory::recording_at(double t_s) const {
  const double last = static_cast<double>(poses_.size() - 1);
  const double x = std::clamp(t_s / step_s_, 0.0, last);
  const auto k = std::min(static_cast<std::size_t>(x), poses_.size() - 2);
  // Catmull–Rom interpolation of the ⊞-differences of neighbouring poses keeps the velocity continuous.
  const Se3& a = poses_[k];
  const double u = x - static_cast<double>(k);
  const Vector6 to_next = boxminus(poses_[k + 1], a);
  const Vector6 before = k > 0 ? Vector6(-boxminus(poses_[k - 1], a)) : to_next;
  const Vector6 after = k + 2 < poses_.size() ? Vector6(boxminus(poses_[k + 2], a) - to_next) : to_next;
  const Vector6 slope0 = 0.5 * (before + to_next);
  const Vector6 slope1 = 0.5 * (to_next + after);
  const double u2 = u * u;
  const double u3 = u2 * u;
  const Vector6 delta = (u3 - 2 * u2 + u) * slope0 + (3 * u2 - 2 * u3) * to_next + (u3 - u2) * slope1;
  return boxplus(a, delta);
}

Se3 Trajectory::at(double t_s) const {
  if (still_) t_s = 0;
  return poses_.empty() ? generated_at(t_s) : recording_at(t_s);
}

}  // namespace plvo::sim
