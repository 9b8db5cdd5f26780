// SPDX-License-Identifier: Apache-2.0
// A simulated RGB-D camera that moves through a ray-cast room and provides its exact pose. The same options
// give the same bytes for any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/replay/wheel_files.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo {

class SimulatedCamera final : public RgbdCamera {
 public:
  // Returns kInvalidArgument for options out of range, or the error of Trajectory::from_tum for a trajectory
  // file.
  static Status create(const SimulatorOptions& options, std::unique_ptr<SimulatedCamera>& camera);
  ~SimulatedCamera();

  CameraModel model() const override;
  // Renders the next frame into the camera's own buffers. kEndOfStream after options.frames frames, or at the
  // end of the recorded trajectory.
  Status next(RgbdFrame& frame) override;

  const SimulatorOptions& options() const;
  // Total number of frames: options.frames, or fewer if the recorded trajectory ends earlier.
  int frames() const;
  // Stamp of frame k: 1 600 000 000 s + k / fps, in whole microseconds, which a TUM folder stores exactly.
  std::int64_t stamp_ns(int frame) const;
  // Stamp of frame k's depth image (options().depth_schedule), also in whole microseconds.
  std::int64_t depth_stamp_ns(int frame) const;
  // Exact T_world_camera of frame k, and at any stamp (evaluated on the trajectory itself, not interpolated
  // between frames).
  Se3 pose(int frame) const;
  Se3 ground_truth(std::int64_t stamp_ns) const;
  // Samples of the gyro and the accelerometer beside the camera, from 0.1 s before the first frame until
  // after the last one. The stamps use the clock of the frames, the axes are those of the camera.
  void inertial_samples(std::vector<ImuSample>& gyro, std::vector<ImuSample>& accelerometer) const;
  // Samples of the wheels of SimulatorOptions::robot, over the same time. They are about its base
  // (robot_camera()).
  void wheel_samples(std::vector<WheelSample>& samples) const;
  // Exact depth of the last frame's pixels (metres along the optical axis, 0: no surface) at the time of
  // their colour exposure, independent of the depth sensor and its schedule.
  ImageView<const float> exact_depth() const;

 private:
  struct Parts;
  explicit SimulatedCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace plvo
