// SPDX-License-Identifier: Apache-2.0
// The RGB-D sensors known to plvo by USB id, with their requirements: the OpenNI2 driver and the port speed.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace plvo {

enum class SensorFamily : std::uint8_t { kKinectV1, kKinectV2, kPrimeSense, kAstra };
enum class SensorPart : std::uint8_t { kCamera, kMotor, kAudio, kHub };

// One USB function of a sensor. A Kinect v1 has three of them behind an internal hub. A Kinect v2 has a
// camera, and a hub on each of the two buses of its USB 3 port; the hub on the slow bus is not a problem.
struct KnownUsbDevice {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  SensorFamily family = SensorFamily::kKinectV1;
  SensorPart part = SensorPart::kCamera;
  const char* name = "";
};

struct SensorNeeds {
  const char* name = "";
  const char* driver_mark = "";    // lower-case substring of the file name of its OpenNI2 driver
  const char* driver_remedy = "";  // how to get that driver
  int min_speed_mbps = 480;        // USB 2: 480, USB 3: 5000
};

std::span<const KnownUsbDevice> known_usb_devices();
const KnownUsbDevice* find_known(std::uint16_t vendor, std::uint16_t product);  // nullptr: unknown device
const SensorNeeds& needs_of(SensorFamily family);

// bcdDevice of the camera of Kinect model 1414. Later models (1473, Kinect for Windows) control motor and LED
// through the audio device.
inline constexpr std::uint16_t kKinect1414Bcd = 0x010b;

}  // namespace plvo
