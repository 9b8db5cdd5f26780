// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/freenect_driver/kinect.hpp"

#include <libusb.h>

#include <algorithm>

namespace plvo {
namespace {

constexpr std::uint16_t kMicrosoft = 0x045e;
constexpr std::uint16_t kKinectCamera = 0x02ae;
constexpr std::uint16_t kKinectForWindowsCamera = 0x02bf;

// The last log message of libfreenect on this thread. A thread_local variable, because its log callback has
// no user pointer.
thread_local std::string last_message;

void keep_message(freenect_context* /*context*/, freenect_loglevel level, const char* message) {
  if (level <= FREENECT_LOG_ERROR) last_message = message;
}

std::string port_of(libusb_device* device) {
  std::uint8_t ports[8];
  const int count = libusb_get_port_numbers(device, ports, sizeof(ports));
  std::string text = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) text.append(i == 0 ? "-" : ".").append(std::to_string(ports[i]));
  return text;
}

// Calls visit(device, descriptor, index) for each camera, with the index used by libfreenect.
template <typename Visit>
void for_each_camera(libusb_context* usb, Visit visit) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(usb, &devices);
  int index = 0;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[i], &descriptor) != 0 || descriptor.idVendor != kMicrosoft)
      continue;
    if (descriptor.idProduct != kKinectCamera && descriptor.idProduct != kKinectForWindowsCamera) continue;
    visit(devices[i], descriptor, index++);
  }
  if (count >= 0) libusb_free_device_list(devices, 1);
}

// libfreenect does not report why it cannot open a camera. This function repeats the two steps that fail in
// practice to find the reason.
std::string try_out(libusb_device* device) {
  libusb_device_handle* handle = nullptr;
  int error = libusb_open(device, &handle);
  if (error == 0) {
    libusb_set_auto_detach_kernel_driver(handle, 1);  // gspca_kinect claims every Kinect as a webcam
    error = libusb_claim_interface(handle, 0);
    if (error == 0) libusb_release_interface(handle, 0);
    libusb_close(handle);
  }
  return error == 0 ? std::string() : libusb_error_name(error);
}

}  // namespace

std::vector<KinectPlug> list_kinects(libusb_context* usb) {
  std::vector<KinectPlug> plugs;
  for_each_camera(usb, [&](libusb_device* device, const libusb_device_descriptor& descriptor, int) {
    plugs.push_back(
        {port_of(device), libusb_get_device_address(device), descriptor.idVendor, descriptor.idProduct});
  });
  return plugs;
}

Kinect::Kinect(KinectListener& listener)
    : listener_(listener), thread_([this] { return process_events(); }, [this] { close_here(); }) {}

bool Kinect::process_events() {
  if (device_ == nullptr || !(depth_runs_ || colour_runs_)) return false;
  timeval wait{0, 10000};
  // An error here means that the device is gone; the driver's bus watch reports this to OpenNI2.
  return freenect_process_events_timeout(freenect_, &wait) >= 0;
}

std::string Kinect::open(const std::string& port) {
  std::string error;
  const bool opened = thread_.call([&] { return (error = open_here(port)).empty(); });
  return opened || !error.empty() ? error : "the Kinect is being closed";
}

std::string Kinect::open_here(const std::string& port) {
  close_here();
  if (const int error = libusb_init(&usb_); error != 0) {
    usb_ = nullptr;
    return libusb_error_name(error);
  }
  std::string error = "no Kinect is plugged in at ";
  error.append(port);
  int found = -1;
  for_each_camera(usb_, [&](libusb_device* device, const libusb_device_descriptor&, int index) {
    if (port_of(device) != port) return;
    found = index;
    error = try_out(device);
  });
  if (error.empty() && freenect_init(&freenect_, usb_) < 0) {
    freenect_ = nullptr;
    error = "libfreenect does not start";
  }
  if (error.empty()) {
    freenect_set_log_callback(freenect_, keep_message);
    freenect_set_log_level(freenect_, FREENECT_LOG_ERROR);
    // The motor and the microphones stay free for other programs (for example plvo tilt).
    freenect_select_subdevices(freenect_, FREENECT_DEVICE_CAMERA);
    last_message.clear();
    if (freenect_open_device(freenect_, &device_, found) < 0) {
      device_ = nullptr;
      error = "libfreenect cannot open the camera: ";
      error.append(last_message);
    }
  }
  if (!error.empty()) {
    close_here();
    return error;
  }
  freenect_set_user(device_, this);
  freenect_set_depth_callback(device_, [](freenect_device* device, void* image, std::uint32_t ticks) {
    auto* self = static_cast<Kinect*>(freenect_get_user(device));
    self->listener_.on_depth(static_cast<const std::uint16_t*>(image), self->to_us(ticks));
  });
  freenect_set_video_callback(device_, [](freenect_device* device, void* image, std::uint32_t ticks) {
    auto* self = static_cast<Kinect*>(freenect_get_user(device));
    self->listener_.on_colour(static_cast<const std::uint8_t*>(image), self->to_us(ticks));
  });
  ticks_ = 0;
  return {};
}

void Kinect::close_here() {
  if (device_ != nullptr) {
    if (depth_runs_) freenect_stop_depth(device_);
    if (colour_runs_) freenect_stop_video(device_);
    freenect_close_device(device_);
  }
  if (freenect_ != nullptr) freenect_shutdown(freenect_);
  if (usb_ != nullptr) libusb_exit(usb_);
  device_ = nullptr;
  freenect_ = nullptr;
  usb_ = nullptr;
  depth_runs_ = colour_runs_ = false;
}

bool Kinect::start_depth_here() {
  if (device_ == nullptr) return false;
  if (depth_runs_) freenect_stop_depth(device_);
  const freenect_depth_format format = registered_ ? FREENECT_DEPTH_REGISTERED : FREENECT_DEPTH_MM;
  depth_runs_ =
      freenect_set_depth_mode(device_, freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, format)) >= 0 &&
      freenect_start_depth(device_) >= 0;
  return depth_runs_;
}

bool Kinect::set_registered(bool registered) {
  return thread_.call([&] {
    registered_ = registered;
    return !depth_runs_ || start_depth_here();
  });
}

bool Kinect::start_depth() {
  return thread_.call([&] { return start_depth_here(); });
}

bool Kinect::start_colour() {
  return thread_.call([&] {
    if (device_ == nullptr) return false;
    if (colour_runs_) return true;
    colour_runs_ = freenect_set_video_mode(device_, freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM,
                                                                             FREENECT_VIDEO_RGB)) >= 0 &&
                   freenect_start_video(device_) >= 0;
    return colour_runs_;
  });
}

void Kinect::stop_depth() {
  thread_.call([&] {
    if (device_ != nullptr && depth_runs_) freenect_stop_depth(device_);
    depth_runs_ = false;
    return true;
  });
}

void Kinect::stop_colour() {
  thread_.call([&] {
    if (device_ != nullptr && colour_runs_) freenect_stop_video(device_);
    colour_runs_ = false;
    return true;
  });
}

// Converts 60 MHz ticks in 32 bits, which wrap every 71.58 s, to 64-bit microseconds. Both streams use one
// clock, and each stamp lies within half a wrap of the newest stamp of either stream.
std::uint64_t Kinect::to_us(std::uint32_t ticks) {
  if (ticks_ == 0) {
    ticks_ = (std::uint64_t{1} << 32) + ticks;  // an earlier stamp of the other stream then is not negative
    return ticks_ / 60;
  }
  const auto step = static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(ticks_));
  const std::uint64_t unwrapped = ticks_ + static_cast<std::uint64_t>(static_cast<std::int64_t>(step));
  if (step > 0) ticks_ = unwrapped;
  return unwrapped / 60;
}

}  // namespace plvo
