// SPDX-License-Identifier: Apache-2.0
#include "plvo/usb/kinect_motor.hpp"

#include <libusb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "plvo/inertial/imu_config.hpp"

namespace plvo {
namespace {

constexpr unsigned kTimeoutMs = 1000;
constexpr double kCountsPerG = 819;
constexpr double kRadPerDegree = 3.14159265358979323846 / 180;

constexpr std::uint32_t kCommandMagic = 0x06022009;
constexpr std::uint32_t kReplyMagic = 0x0a6fe000;
constexpr unsigned char kBulkOut = 0x01;
constexpr unsigned char kBulkIn = 0x81;

Status usb_error(int error, const char* what) {
  const StatusCode code = error == LIBUSB_ERROR_ACCESS      ? StatusCode::kPermission
                          : error == LIBUSB_ERROR_BUSY      ? StatusCode::kBusy
                          : error == LIBUSB_ERROR_NO_DEVICE ? StatusCode::kUnplugged
                          : error == LIBUSB_ERROR_TIMEOUT   ? StatusCode::kTimeout
                                                            : StatusCode::kIo;
  Status status(code, what);
  status.append(": ").append(libusb_strerror(error));
  if (code == StatusCode::kPermission)
    status.append("; install the udev rule 60-plvo-rgbd.rules and replug (over ssh: be in the group video)");
  if (code == StatusCode::kBusy) status.append("; another program holds it");
  return status;
}

void put_le32(std::uint8_t* to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(value >> (8 * i));
}
std::uint32_t get_le32(const std::uint8_t* from) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(from[i]) << (8 * i);
  return value;
}
double get_be16(const std::uint8_t* from) { return static_cast<std::int16_t>((from[0] << 8) | from[1]); }

int light_on_motor(KinectLight light) {
  switch (light) {
    case KinectLight::kOff: return 0;
    case KinectLight::kGreen: return 1;
    case KinectLight::kRed: return 2;
    case KinectLight::kYellow: return 3;
    case KinectLight::kBlinkGreen: return 4;
    case KinectLight::kBlinkRedYellow: return 6;
  }
  return 0;
}

// The audio device has fewer lights; this is the most similar one.
std::uint32_t light_on_audio(KinectLight light) {
  switch (light) {
    case KinectLight::kOff: return 1;
    case KinectLight::kBlinkGreen: return 2;
    case KinectLight::kGreen: return 3;
    case KinectLight::kRed:
    case KinectLight::kYellow:
    case KinectLight::kBlinkRedYellow: return 4;
  }
  return 1;
}

// True for ports of one hub: "1-1.1" and "1-1.3" both belong to 1-1.
bool same_hub(const std::string& port, const std::string& camera_port) {
  const std::size_t hub = camera_port.find_last_of(".-");
  return hub == std::string::npos || port.substr(0, port.find_last_of(".-")) == camera_port.substr(0, hub);
}

}  // namespace

KinectMotor::~KinectMotor() { close(); }

void KinectMotor::close() {
  if (handle_ == nullptr) return;
  if (through_audio_) libusb_release_interface(handle_, 0);
  libusb_close(handle_);
  handle_ = nullptr;
}

Status KinectMotor::open(const UsbBus& bus, const std::string& camera_port) {
  close();
  const std::vector<UsbDeviceFacts> devices = bus.list();
  const UsbDeviceFacts* camera = nullptr;
  const UsbDeviceFacts* motor = nullptr;
  const UsbDeviceFacts* audio = nullptr;
  for (const UsbDeviceFacts& device : devices) {
    if (device.known.family != SensorFamily::kKinectV1 || !same_hub(device.port, camera_port)) continue;
    if (device.known.part == SensorPart::kCamera && camera == nullptr) camera = &device;
    if (device.known.part == SensorPart::kMotor && motor == nullptr) motor = &device;
    if (device.known.part == SensorPart::kAudio && audio == nullptr) audio = &device;
  }
  const bool is_1414 = camera == nullptr || camera->bcd == kKinect1414Bcd;
  through_audio_ = motor == nullptr || (!is_1414 && audio != nullptr);
  const UsbDeviceFacts* chosen = through_audio_ ? audio : motor;
  if (chosen == nullptr) {
    return {StatusCode::kNotFound, "no Kinect v1 motor on the USB; is the Kinect plugged in and on 12 V?"};
  }

  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(bus.context(), &list);
  int error = LIBUSB_ERROR_NO_DEVICE;
  for (ssize_t i = 0; i < count; ++i) {
    if (libusb_get_bus_number(list[i]) == chosen->bus &&
        libusb_get_device_address(list[i]) == chosen->address) {
      error = libusb_open(list[i], &handle_);
    }
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
  if (error == 0 && through_audio_) {
    // A sound driver may hold the interface; it gets it back when the interface is released.
    libusb_set_auto_detach_kernel_driver(handle_, 1);
    error = libusb_claim_interface(handle_, 0);
    if (error != 0) libusb_close(handle_);
  }
  if (error != 0) {
    handle_ = nullptr;
    return usb_error(error, through_audio_ ? "cannot open the Kinect's audio device (it holds the motor)"
                                           : "cannot open the Kinect's motor");
  }
  return {};
}

Status KinectMotor::audio_command(std::uint32_t command, std::uint32_t argument, std::uint8_t* data,
                                  int data_size) {
  std::array<std::uint8_t, 20> request{};
  const std::uint32_t tag = tag_++;
  put_le32(&request[0], kCommandMagic);
  put_le32(&request[4], tag);
  put_le32(&request[8], static_cast<std::uint32_t>(data_size));
  put_le32(&request[12], command);
  put_le32(&request[16], argument);
  constexpr const char* kWhat = "the Kinect's audio device does not answer (is its firmware loaded?)";
  int moved = 0;
  int error = libusb_bulk_transfer(handle_, kBulkOut, request.data(), static_cast<int>(request.size()),
                                   &moved, kTimeoutMs);
  if (error != 0) return usb_error(error, kWhat);
  if (data_size > 0) {
    error = libusb_bulk_transfer(handle_, kBulkIn, data, data_size, &moved, kTimeoutMs);
    if (error != 0) return usb_error(error, kWhat);
    if (moved != data_size)
      return Status(StatusCode::kDamaged, "short answer from the Kinect's audio device");
  }
  std::array<std::uint8_t, 12> reply{};
  error = libusb_bulk_transfer(handle_, kBulkIn, reply.data(), static_cast<int>(reply.size()), &moved,
                               kTimeoutMs);
  if (error != 0) return usb_error(error, kWhat);
  if (moved != 12 || get_le32(&reply[0]) != kReplyMagic || get_le32(&reply[4]) != tag ||
      get_le32(&reply[8]) != 0) {
    return Status(StatusCode::kDamaged, "the Kinect's audio device refused a command, status ")
        .append(static_cast<std::ptrdiff_t>(get_le32(&reply[8])));
  }
  return {};
}

Status KinectMotor::set_tilt(double tilt_rad) {
  if (handle_ == nullptr) return {StatusCode::kInvalidArgument, "the motor is not open"};
  if (!std::isfinite(tilt_rad)) return {StatusCode::kInvalidArgument, "the tilt is not a finite number"};
  const double degrees = std::clamp(tilt_rad, -kMaxTiltRad, kMaxTiltRad) / kRadPerDegree;
  if (through_audio_) {
    const auto whole = static_cast<std::int32_t>(std::lround(degrees));
    return audio_command(0x803b, static_cast<std::uint32_t>(whole), nullptr, 0);
  }
  const auto half_degrees = static_cast<std::int16_t>(std::lround(degrees * 2));
  const int error = libusb_control_transfer(handle_, 0x40, 0x31, static_cast<std::uint16_t>(half_degrees), 0,
                                            nullptr, 0, kTimeoutMs);
  return error < 0 ? usb_error(error, "cannot tilt the Kinect") : Status();
}

Status KinectMotor::set_light(KinectLight light) {
  if (handle_ == nullptr) return {StatusCode::kInvalidArgument, "the motor is not open"};
  if (through_audio_) return audio_command(0x10, light_on_audio(light), nullptr, 0);
  const int error = libusb_control_transfer(
      handle_, 0x40, 0x06, static_cast<std::uint16_t>(light_on_motor(light)), 0, nullptr, 0, kTimeoutMs);
  return error < 0 ? usb_error(error, "cannot set the Kinect's light") : Status();
}

Status KinectMotor::read(KinectState& state) {
  if (handle_ == nullptr) return {StatusCode::kInvalidArgument, "the motor is not open"};
  state = {};
  if (through_audio_) {
    std::array<std::uint8_t, 104> data{};
    const Status status = audio_command(0x8032, 0, data.data(), static_cast<int>(data.size()));
    if (!status.ok()) return status;
    const auto field = [&data](std::size_t at) {
      return static_cast<double>(static_cast<std::int32_t>(get_le32(&data[at])));
    };
    state.acceleration = Vector3(field(16), field(20), field(24)) * (kStandardGravity / kCountsPerG);
    state.tilt_rad = field(28) * kRadPerDegree;
    return {};
  }
  std::array<std::uint8_t, 10> data{};
  const int got = libusb_control_transfer(handle_, 0xC0, 0x32, 0, 0, data.data(),
                                          static_cast<std::uint16_t>(data.size()), kTimeoutMs);
  if (got < 0) return usb_error(got, "cannot read the Kinect's state");
  if (got != static_cast<int>(data.size()))
    return {StatusCode::kDamaged, "short answer from the Kinect's motor"};
  state.acceleration =
      Vector3(get_be16(&data[2]), get_be16(&data[4]), get_be16(&data[6])) * (kStandardGravity / kCountsPerG);
  state.moving = data[9] == 4;
  state.at_limit = data[9] == 1;
  // While the motor moves, the angle reads −128.
  state.tilt_rad = static_cast<double>(static_cast<std::int8_t>(data[8])) / 2 * kRadPerDegree;
  return {};
}

}  // namespace plvo
