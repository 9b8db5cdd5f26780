// SPDX-License-Identifier: Apache-2.0
// The Kinect v1's motor, light and accelerometer. Model 1414 has a separate USB device for them (control
// transfers). Model 1473 and Kinect for Windows accept commands on the audio device (bulk transfers), and
// only while the audio firmware runs. The protocols are those documented by the OpenKinect project.
#pragma once

#include <cstdint>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/math/types.hpp"
#include "plvo/usb/usb_bus.hpp"

struct libusb_device_handle;

namespace plvo {

enum class KinectLight : std::uint8_t { kOff, kGreen, kRed, kYellow, kBlinkGreen, kBlinkRedYellow };

struct KinectState {
  Vector3 acceleration =
      Vector3::Zero();  // m/s², the Kinect's axes: x right, y up, z forward; at rest the reaction to gravity
  double tilt_rad = 0;  // angle of the head to the horizon, up positive; invalid while moving
  bool moving = false;
  bool at_limit = false;
};

class KinectMotor {
 public:
  static constexpr double kMaxTiltRad = 31 * 3.14159265358979323846 / 180;

  KinectMotor() = default;
  ~KinectMotor();
  KinectMotor(const KinectMotor&) = delete;
  KinectMotor& operator=(const KinectMotor&) = delete;

  // Opens the motor of the Kinect v1 whose camera is at this port ("1-1.3"); both are on the Kinect's
  // internal hub. Without a port, opens the first motor on the bus. Returns kNotFound, kPermission or kBusy
  // with a remedy in the message.
  Status open(const UsbBus& bus, const std::string& camera_port = {});
  void close();

  // Clamped to ±31°. Returns immediately; read() reports when the head has arrived.
  Status set_tilt(double tilt_rad);
  Status set_light(KinectLight light);
  Status read(KinectState& state);

  bool through_audio() const { return through_audio_; }

 private:
  Status audio_command(std::uint32_t command, std::uint32_t argument, std::uint8_t* data, int data_size);

  libusb_device_handle* handle_ = nullptr;
  bool through_audio_ = false;
  std::uint32_t tag_ = 1;
};

}  // namespace plvo
