// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/tum_folder.hpp"

#include <cmath>

#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/tum_writer.hpp"

namespace plvo {

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
    }
    const Se3 T_world_camera = camera.ground_truth(frame.stamp_ns);
    if (status = folder.write(frame, &T_world_camera); !status.ok()) return status;
    ++written;
    if (progress && !progress(written, camera.frames())) return {};
  }
}

}  // namespace plvo
