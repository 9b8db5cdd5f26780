// SPDX-License-Identifier: Apache-2.0
// A simulated camera that can be put at any pose in its room; SimulatedCamera follows a trajectory.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/render/renderer.hpp"
#include "plvo/simulator/scene/lighting.hpp"
#include "plvo/simulator/scene/scene.hpp"
#include "plvo/simulator/scene/things.hpp"
#include "plvo/simulator/sensor/film.hpp"
#include "plvo/simulator/sensor/kinect_depth.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

class PosedCamera {
 public:
  // T_world_camera at a time in seconds. The light is that of SimulatedCamera at this time.
  using Motion = std::function<Se3(double t_s)>;

  explicit PosedCamera(const SimulatorOptions& options);
  PosedCamera(const PosedCamera&) = delete;
  PosedCamera& operator=(const PosedCamera&) = delete;

  const CameraModel& model() const { return options_.camera; }
  double frame_s() const { return 1 / options_.fps; }
  double duration_s() const { return trajectory_.duration_s(); }
  // T_world_camera on the trajectory that SimulatedCamera follows with the same options.
  Se3 trajectory(double t_s) const { return trajectory_.at(t_s); }

  // The next frame is exposed as by a camera that has been there for long.
  void arrive() { film_.emplace(options_.camera, options_.seed, true, 1); }
  // Renders a frame, valid until the next call. Each call has noise of its own. The stamp is the caller's.
  RgbdFrame take(const Motion& T_world_camera, double t_s, std::int64_t stamp_ns);
  // Whether the camera could be moved there: nothing is in the way, nor within 0.25 m beyond.
  bool is_free(const Vector3& from, const Vector3& to) const;

 private:
  SimulatorOptions options_;
  std::unique_ptr<sim::Scene> scene_;
  sim::Trajectory trajectory_;
  sim::Lighting lighting_;
  sim::Things things_;
  sim::Renderer renderer_;
  std::optional<sim::Film> film_;
  sim::KinectDepth sensor_;
  std::uint32_t taken_ = 0;
};

}  // namespace plvo::bench
