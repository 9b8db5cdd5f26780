// SPDX-License-Identifier: Apache-2.0
// The RGB-D sensors that plvo knows by their USB ids, and what each one needs: which OpenNI2 driver
// serves it and how fast a port it wants.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace plvo {

enum class SensorFamily : std::uint8_t { kKinectV1, kKinectV2, kPrimeSense, kAstra };
enum class SensorPart : std::uint8_t { kCamera, kMotor, kAudio, kHub };

// One USB function of a sensor. A Kinect v1 shows three of them behind a hub of its own; a Kinect v2 a
// camera, and a hub on either bus of its USB 3 port, which is no trouble on the slow one.
struct KnownUsbDevice {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  SensorFamily family = SensorFamily::kKinectV1;
  SensorPart part = SensorPart::kCamera;
  const char* name = "";
};

struct SensorNeeds {
  const char* name = "";
  const char* driver_mark = "";    // what the file name of an OpenNI2 driver for it contains, lower case
  const char* driver_remedy = "";  // how to get that driver
  int min_speed_mbps = 480;        // USB 2: 480, USB 3: 5000
};

std::span<const KnownUsbDevice> known_usb_devices();
const KnownUsbDevice* find_known(std::uint16_t vendor, std::uint16_t product);  // nullptr: not ours
const SensorNeeds& needs_of(SensorFamily family);

// bcdDevice of the camera of Kinect model 1414. The later ones (1473, Kinect for Windows) drive motor and LED
// through the audio device.
inline constexpr std::uint16_t kKinect1414Bcd = 0x010b;

}  // namespace plvo
