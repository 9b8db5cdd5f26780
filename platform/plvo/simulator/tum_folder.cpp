// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/tum_folder.hpp"

#include <cmath>
#include <filesystem>

#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/tum_writer.hpp"
#include "plvo/replay/wheel_files.hpp"

namespace plvo {

namespace {

Status write_wheels(const SimulatedCamera& camera, const std::string& folder) {
  WheelRecording wheels;
  camera.wheel_samples(wheels.samples);
  return write_wheel_file(std::filesystem::path(folder) / kWheelFile, wheels);
}

}  // namespace

Status write_tum_folder(SimulatedCamera& camera, const std::string& name, const WriteProgress& progress) {
  TumWriter folder;
  RgbdFrame frame;
  for (int written = 0;;) {
    Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (!status.ok()) return status;
    if (written == 0) {
      Calibration calibration;
      calibration.camera = camera.model();
      // The format has a whole number of units per metre; the inverse is rounded because it may not be exact.
      calibration.depth_units_per_metre = std::round(1 / frame.depth.metres_per_unit);
      calibration.depth_scale_given = calibration.readout_given = true;
      if (status = folder.open(name, calibration); !status.ok()) return status;
      ImuRecording imu;
      camera.inertial_samples(imu.gyro, imu.accelerometer);
      if (status = write_imu_files(name, imu); !status.ok()) return status;
      if (camera.options().robot)
        if (status = write_wheels(camera, name); !status.ok()) return status;
    }
    const Se3 T_world_camera = camera.ground_truth(frame.stamp_ns);
    if (status = folder.write(frame, &T_world_camera); !status.ok()) return status;
    ++written;
    if (progress && !progress(written, camera.frames())) return {};
  }
}

}  // namespace plvo
