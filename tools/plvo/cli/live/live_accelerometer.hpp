// SPDX-License-Identifier: Apache-2.0
// `--imu` of a live session: the accelerometer of a Kinect v1 beside its camera. Its readings come by the
// computer's clock and are taken over to the clock of the frames; whatever is wrong with it is said once, and
// poses are tracked without gravity.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/host/arrival_clock.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/inertial/imu_integrator.hpp"

namespace plvo {
class KinectAccelerometer;
}

namespace plvo::cli {

struct AccelerometerSummary {
  bool used = false;
  std::uint64_t readings = 0, late = 0, failures = 0;
};

class LiveAccelerometer {
 public:
  explicit LiveAccelerometer(Console& console);
  ~LiveAccelerometer();

  // kUnsupported where plvo was built without libusb. A camera that has no accelerometer is warned of, and
  // nothing comes then; level: the world waits for it, so that this is kUnsupported, too.
  Status start(const LiveCamera& camera, bool level);
  void stop();

  // Called for each frame that is tracked or kept, in their order; arrival_ns by posix_monotonic_ns().
  // Returns the integrator with the readings that are there, or nullptr without a sensor.
  ImuIntegrator* until(std::int64_t stamp_ns, std::int64_t arrival_ns);

  // From here on readings go into accelerometer.txt in this folder as well, from the next frame on, when the
  // folder is there. A full disk ends the file alone, in words; failure() then says that it did.
  void keep_in(const std::string& folder) { folder_ = folder; }
  const Status& failure() const { return failure_; }

  AccelerometerSummary summary() const;

 private:
  void keep(const ImuSample& sample);

  Console& console_;
  std::unique_ptr<KinectAccelerometer> sensor_;
  ArrivalClock clock_;
  std::vector<ImuSample> memory_;
  ImuIntegrator integrator_;
  std::string folder_;
  LineFile file_;
  Status failure_;
};

}  // namespace plvo::cli
