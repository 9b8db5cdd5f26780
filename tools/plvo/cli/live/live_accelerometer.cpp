// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_accelerometer.hpp"

#include <filesystem>
#include <optional>
#include <string_view>

#include "plvo/replay/imu_files.hpp"
#include "plvo/usb/kinect_accelerometer.hpp"

namespace plvo::cli {
namespace {

// A Kinect sends an image in the time of one frame, and stamps its beginning. The time from the exposure to
// the stamp, and that through the USB, have not been measured: some 20 ms.
constexpr std::int64_t kKinectDelay_ns = 33'000'000;
constexpr std::string_view kKinectScheme = "freenect://";
constexpr std::size_t kWaiting = 512;  // five seconds of readings

// Axes: x right, y up, z forward. The noise of the sensor has not been measured either: a reading is
// taken as good to 0.05 m/s² (its steps are 0.012), a hundred a second. A turn of 1 rad/s moves gravity by
// 0.2 m/s² in the 20 ms of above, which is added to what a hand accelerates the camera by.
ImuConfig kinect_config() {
  ImuConfig config;
  config.R_camera_imu = Vector3(1, -1, 1).asDiagonal();
  config.accelerometer_noise = 5e-3;
  config.acceleration = 0.65;
  return config;
}

}  // namespace

LiveAccelerometer::LiveAccelerometer(Console& console)
    : console_(console), clock_(kKinectDelay_ns), memory_(kWaiting) {}

LiveAccelerometer::~LiveAccelerometer() = default;

#ifdef PLVO_HAVE_USB

Status LiveAccelerometer::start(const LiveCamera& camera, bool level) {
  const std::string uri = camera.uri();
  const bool kinect = uri.rfind(kKinectScheme, 0) == 0;
  if (!kinect && level)
    return {StatusCode::kUnsupported,
            "--level: a Kinect v1 is the only live sensor whose accelerometer is read; leave it out"};
  if (!kinect) {
    console_.write(LogLevel::kWarning,
                   "--imu: a Kinect v1 is the only live sensor whose accelerometer is read; poses are "
                   "tracked without gravity");
    return {};
  }
  if (Status status = integrator_.init({}, memory_, kinect_config()); !status.ok()) return status;
  sensor_ = std::make_unique<KinectAccelerometer>(
      console_, level ? "the level world waits for it" : "poses are tracked without gravity");
  sensor_->start(uri.substr(kKinectScheme.size()));
  return {};
}

void LiveAccelerometer::stop() {
  if (sensor_) sensor_->stop();
}

ImuIntegrator* LiveAccelerometer::until(std::int64_t stamp_ns, std::int64_t arrival_ns) {
  if (!sensor_) return nullptr;
  clock_.frame_arrived(stamp_ns, arrival_ns);
  std::vector<KinectReading> readings;
  sensor_->take(readings);
  for (const KinectReading& reading : readings) {
    const ImuSample sample = {*clock_.stamp_of(reading.host_ns), reading.force};
    if (integrator_.add_acceleration(sample)) keep(sample);
  }
  return &integrator_;
}

AccelerometerSummary LiveAccelerometer::summary() const {
  if (!sensor_) return {};
  const KinectAccelerometer::Counters counters = sensor_->counters();
  return {true, counters.readings, counters.late, counters.failures};
}

#else

}  // namespace plvo::cli

// Its room was left out.
class plvo::KinectAccelerometer {};

namespace plvo::cli {

Status LiveAccelerometer::start(const LiveCamera&, bool) {
  return {StatusCode::kUnsupported,
          "--imu: this plvo was built without libusb: sudo apt install libusb-1.0-0-dev, then configure and "
          "build again"};
}
void LiveAccelerometer::stop() {}
ImuIntegrator* LiveAccelerometer::until(std::int64_t, std::int64_t) { return nullptr; }
AccelerometerSummary LiveAccelerometer::summary() const { return {}; }

#endif

void LiveAccelerometer::keep(const ImuSample& sample) {
  if (folder_.empty()) return;
  if (!file_.is_open())
    failure_ = file_.open((std::filesystem::path(folder_) / kAccelerometerFile).string(),
                          imu_header(kAccelerometerFile, ImuAxes::kKinect));
  if (failure_.ok()) failure_ = file_.write(imu_line(sample));
  if (failure_.ok()) return;
  console_.write(LogLevel::kError, failure_.message());
  folder_.clear();
}

}  // namespace plvo::cli
