// SPDX-License-Identifier: Apache-2.0
// A camera that exists only in the computer: it is carried through a ray-cast room under a light, and knows
// exactly where it was. The same options give the same bytes, whatever the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo {

class SimulatedCamera final : public RgbdCamera {
 public:
  // kInvalidArgument for options out of range; what Trajectory::from_tum says for a trajectory file.
  static Status create(const SimulatorOptions& options, std::unique_ptr<SimulatedCamera>& camera);
  ~SimulatedCamera();

  CameraModel model() const override;
  // Renders the next frame into the camera's own buffers. kEndOfStream after options.frames frames, or at the
  // end of the recorded trajectory.
  Status next(RgbdFrame& frame) override;

  const SimulatorOptions& options() const;
  // How many frames there will be: options.frames, or fewer if the recorded trajectory ends earlier.
  int frames() const;
  // Stamp of frame k: 1 600 000 000 s + k / fps, in whole microseconds, so that a TUM folder keeps it
  // exactly.
  std::int64_t stamp_ns(int frame) const;
  // Stamp that frame k's depth image bears (options().depth_schedule), in whole microseconds too.
  std::int64_t depth_stamp_ns(int frame) const;
  // T_world_camera, exact: of frame k, and at any stamp (of the walk itself, not interpolated between
  // frames).
  Se3 pose(int frame) const;
  Se3 ground_truth(std::int64_t stamp_ns) const;
  // What the gyro and the accelerometer beside the camera read, from a tenth of a second before the first
  // frame to after the last one; stamps are those of the frames' clock, axes those of the camera.
  void inertial_samples(std::vector<ImuSample>& gyro, std::vector<ImuSample>& accelerometer) const;
  // Exact depth (metres along the optical axis, 0: nothing) of the last frame's pixels at the moment of their
  // colour, whatever the depth sensor made of it, and when.
  ImageView<const float> exact_depth() const;

 private:
  struct Parts;
  explicit SimulatedCamera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace plvo
