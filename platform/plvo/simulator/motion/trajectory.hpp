// SPDX-License-Identifier: Apache-2.0
// The pose of the camera at any time: a hand-held trajectory generated from a seed, or a recorded TUM
// trajectory. The generated trajectory follows the scene's closed spline. Steps, sway and hand tremor are
// added as sums of sinusoids with whole numbers of periods, so the trajectory ends exactly at its first pose.
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
  // A closed trajectory of `duration_s` seconds: at(0) and at(duration_s) are the same pose.
  static Trajectory hand_held(const Scene& scene, std::uint64_t seed, double duration_s);

  // Lines "t tx ty tz qx qy qz qw" (camera to world, optical frame, z up). The trajectory is lightly smoothed
  // to remove the 0.1 mm steps of motion capture, then rotated about the vertical and shifted to the start of
  // the scene's own trajectory. It is scaled down, never up, to fit into the scene's free space. Returns the
  // error of read_trajectory for an unreadable file, and kDamaged for rows with a NaN or a repeated stamp.
  static Status from_tum(const std::string& path, const Scene& scene, Trajectory& trajectory);

  // The same path of a camera on a robot: level at the height of the first pose, without a hand's sway. The
  // rumble of the floor is left.
  void put_on_robot();
  // Stays at the first pose.
  void stop() { still_ = true; }
  // T_world_camera. Times outside 0 … duration_s() are clamped for a recording and wrap around for a
  // generated trajectory.
  Se3 at(double t_s) const;
  double duration_s() const { return duration_s_; }
  double scale() const { return scale_; }  // scale of a recording, ≤ 1

 private:
  struct Wave {
    double amplitude = 0;  // m or rad
    int periods = 1;       // over the whole trajectory
    double phase_rad = 0;
  };
  static constexpr int kWaves = 5;  // per degree of freedom

  Se3 generated_at(double t_s) const;
  Se3 recording_at(double t_s) const;

  bool still_ = false;
  bool on_robot_ = false;
  double duration_s_ = 0;
  double scale_ = 1;
  // Generated trajectory:
  std::vector<PathPoint> points_;
  double extent_ = 1;  // scale of the stroll about its first point
  int rounds_ = 1;
  bool winding_ = false;
  std::array<std::array<Wave, kWaves>, 6> waves_;
  // Recorded trajectory, at a fixed rate:
  std::vector<Se3> poses_;
  double step_s_ = 0;
};

}  // namespace plvo::sim
