// SPDX-License-Identifier: Apache-2.0
// Where the camera is at any moment: a walk with a camera in the hand, made from a seed, or a recorded TUM
// trajectory. The seeded walk follows the scene's closed spline; on top of it come the steps, the sway and
// the tremor of a hand as sums of sinusoids with a whole number of periods, so that the walk ends exactly
// where it began.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

class Trajectory {
 public:
  // A closed walk of `duration_s` seconds: at(0) and at(duration_s) are the same pose.
  static Trajectory hand_held(const Scene& scene, std::uint64_t seed, double duration_s);

  // Lines "t tx ty tz qx qy qz qw" (camera to world, optical frame, z up). Smoothed lightly against the 0.1
  // mm steps of motion capture, turned about the vertical and shifted so that it starts where the scene's
  // walk does, and scaled down, never up, as far as the scene's free space asks. What read_trajectory says of
  // a file that it cannot read; kDamaged for rows with a NaN or a repeated stamp.
  static Status from_tum(const std::string& path, const Scene& scene, Trajectory& trajectory);

  // T_world_camera. Times outside 0 … duration_s() are clamped for a recording and wrap for a walk.
  Se3 at(double t_s) const;
  double duration_s() const { return duration_s_; }
  double scale() const { return scale_; }  // of a recording, ≤ 1

 private:
  struct Wave {
    double amplitude = 0;  // m or rad
    int periods = 1;       // over the whole walk
    double phase_rad = 0;
  };
  static constexpr int kWaves = 5;  // per degree of freedom

  Se3 walk_at(double t_s) const;
  Se3 recording_at(double t_s) const;

  double duration_s_ = 0;
  double scale_ = 1;
  // A walk:
  std::vector<WalkPoint> points_;
  double extent_ = 1;  // of the stroll, towards its first point
  int rounds_ = 1;
  bool winding_ = false;
  std::array<std::array<Wave, kWaves>, 6> waves_;
  // A recording, at a fixed rate:
  std::vector<Se3> poses_;
  double step_s_ = 0;
};

}  // namespace plvo::sim
