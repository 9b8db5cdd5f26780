// SPDX-License-Identifier: Apache-2.0
#include "plvo/usb/known_sensors.hpp"

#include <array>

namespace plvo {
namespace {

constexpr std::uint16_t kMicrosoft = 0x045e;
constexpr std::uint16_t kPrimeSense = 0x1d27;
constexpr std::uint16_t kOrbbec = 0x2bc5;

constexpr std::array kKnown = {
    KnownUsbDevice{kMicrosoft, 0x02ae, SensorFamily::kKinectV1, SensorPart::kCamera, "Kinect v1 camera"},
    KnownUsbDevice{kMicrosoft, 0x02b0, SensorFamily::kKinectV1, SensorPart::kMotor, "Kinect v1 motor"},
    KnownUsbDevice{kMicrosoft, 0x02ad, SensorFamily::kKinectV1, SensorPart::kAudio, "Kinect v1 audio"},
    KnownUsbDevice{kMicrosoft, 0x02bf, SensorFamily::kKinectV1, SensorPart::kCamera,
                   "Kinect for Windows camera"},
    KnownUsbDevice{kMicrosoft, 0x02be, SensorFamily::kKinectV1, SensorPart::kAudio,
                   "Kinect for Windows audio"},
    KnownUsbDevice{kMicrosoft, 0x02c3, SensorFamily::kKinectV1, SensorPart::kAudio,
                   "Kinect for Windows audio"},
    KnownUsbDevice{kMicrosoft, 0x02bb, SensorFamily::kKinectV1, SensorPart::kAudio,
                   "Kinect for Windows audio"},
    KnownUsbDevice{kMicrosoft, 0x02c4, SensorFamily::kKinectV2, SensorPart::kCamera, "Kinect v2"},
    KnownUsbDevice{kMicrosoft, 0x02d8, SensorFamily::kKinectV2, SensorPart::kCamera, "Kinect v2 for Windows"},
    KnownUsbDevice{kMicrosoft, 0x02d9, SensorFamily::kKinectV2, SensorPart::kHub, "Kinect v2 hub"},
    KnownUsbDevice{kPrimeSense, 0x0500, SensorFamily::kPrimeSense, SensorPart::kCamera, "PrimeSense sensor"},
    KnownUsbDevice{kPrimeSense, 0x0600, SensorFamily::kPrimeSense, SensorPart::kCamera, "Asus Xtion Pro"},
    KnownUsbDevice{kPrimeSense, 0x0601, SensorFamily::kPrimeSense, SensorPart::kCamera,
                   "Asus Xtion Pro Live"},
    KnownUsbDevice{kPrimeSense, 0x0609, SensorFamily::kPrimeSense, SensorPart::kCamera, "PrimeSense Carmine"},
    KnownUsbDevice{kOrbbec, 0x0401, SensorFamily::kAstra, SensorPart::kCamera, "Orbbec Astra"},
    KnownUsbDevice{kOrbbec, 0x0402, SensorFamily::kAstra, SensorPart::kCamera, "Orbbec Astra S"},
    KnownUsbDevice{kOrbbec, 0x0403, SensorFamily::kAstra, SensorPart::kCamera, "Orbbec Astra Pro"},
    KnownUsbDevice{kOrbbec, 0x0404, SensorFamily::kAstra, SensorPart::kCamera, "Orbbec Astra Mini"},
};

constexpr SensorNeeds kKinectV1Needs = {
    "Kinect v1", "freenect",
    "plvo brings its own: install libfreenect-dev, then configure, build and install plvo again.", 480};
constexpr SensorNeeds kKinectV2Needs = {"Kinect v2", "freenect2",
                                        "Debian has no driver for it: build libfreenect2 with its OpenNI2 "
                                        "driver, and copy libfreenect2-openni2.so.0 "
                                        "there.",
                                        5000};
constexpr SensorNeeds kPrimeSenseNeeds = {"Xtion / PrimeSense", "ps1080",
                                          "It comes with Debian's libopenni2-0: sudo apt install "
                                          "--reinstall libopenni2-0.",
                                          480};
constexpr SensorNeeds kAstraNeeds = {"Orbbec Astra", "orbbec",
                                     "Debian has no driver for it: take liborbbec.so from the vendor's "
                                     "OpenNI2 package and copy it there under the "
                                     "name liborbbec.so.0.",
                                     480};

}  // namespace

std::span<const KnownUsbDevice> known_usb_devices() { return kKnown; }

const KnownUsbDevice* find_known(std::uint16_t vendor, std::uint16_t product) {
  for (const KnownUsbDevice& known : kKnown) {
    if (known.vendor == vendor && known.product == product) return &known;
  }
  return nullptr;
}

const SensorNeeds& needs_of(SensorFamily family) {
  switch (family) {
    case SensorFamily::kKinectV1: return kKinectV1Needs;
    case SensorFamily::kKinectV2: return kKinectV2Needs;
    case SensorFamily::kPrimeSense: return kPrimeSenseNeeds;
    case SensorFamily::kAstra: return kAstraNeeds;
  }
  return kKinectV1Needs;
}

}  // namespace plvo
