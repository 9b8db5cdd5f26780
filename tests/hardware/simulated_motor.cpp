// SPDX-License-Identifier: Apache-2.0
#include "simulated_motor.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "simulated_usb.hpp"

namespace plvo_test {
namespace {

constexpr int kAddress = 100;  // above the camera's addresses

std::vector<std::uint8_t> motor_descriptors() {
  return {18, 1, 0x00, 0x02, 0, 0, 0, 64,   0x5e, 0x04, 0xb0, 0x02, 0x07, 0x01, 0, 0, 0, 1,  //
          9,  2, 18,   0,    1, 1, 0, 0xc0, 50,                                              //
          9,  4, 0,    0,    0, 0, 0, 0,    0};
}

}  // namespace

SimulatedMotor::~SimulatedMotor() {
  if (handler_ == nullptr) return;
  umockdev_testbed_detach_ioctl(kinect_.testbed(), usb_node(kAddress).c_str(), nullptr);
  g_object_unref(handler_);
}

void SimulatedMotor::plug() {
  const std::string sysfs = kinect_.hub() + "/1-1.1", node = usb_node(kAddress);
  add_to_testbed(kinect_.testbed(), usb_description(sysfs, node, kAddress, motor_descriptors()));
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&SimulatedMotor::on_ioctl), this);
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(kinect_.testbed(), node.c_str(), handler_, &error) == FALSE)
    throw std::runtime_error(error->message);
  umockdev_testbed_uevent(kinect_.testbed(), sysfs.c_str(), "add");
}

gboolean SimulatedMotor::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& self = *static_cast<SimulatedMotor*>(user);
  const UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  void* pointer = nullptr;
  std::memcpy(&pointer, arg->data, sizeof(pointer));
  const std::lock_guard lock(self.mutex_);
  int error = 0;
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES: *static_cast<std::uint32_t*>(pointer) = 0; break;
    case USBDEVFS_SUBMITURB: {
      auto* urb = static_cast<usbdevfs_urb*>(pointer);
      auto* buffer = static_cast<std::uint8_t*>(urb->buffer);
      const int moved = urb->type == USBDEVFS_URB_TYPE_CONTROL
                            ? self.control(buffer, buffer + 8, urb->buffer_length - 8)
                            : -EPIPE;
      urb->status = std::min(moved, 0);
      urb->actual_length = std::max(moved, 0);
      self.done_.push_back(urb);
      break;
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      error = self.done_.empty() ? EAGAIN : 0;
      if (error != 0) break;
      *static_cast<usbdevfs_urb**>(pointer) = self.done_.front();
      self.done_.pop_front();
      break;
    case USBDEVFS_SETCONFIGURATION: break;
    default: error = ENOTTY; break;
  }
  umockdev_ioctl_client_complete(client, error != 0 ? -1 : 0, error);
  return TRUE;
}

// Vendor request 0x32 returns ten bytes: the accelerometer's axes in big-endian counts and the tilt in half
// degrees.
int SimulatedMotor::control(const std::uint8_t* setup, std::uint8_t* data, int length) {
  if (setup[0] != 0xc0 || setup[1] != 0x32 || length != 10) return -EPIPE;
  ++questions_;
  if (error_ != 0) return -error_;
  std::memset(data, 0, 10);
  const std::array<int, 3> counts = reads_();
  for (std::size_t i = 0; i < 3; ++i) {
    data[2 + 2 * i] = static_cast<std::uint8_t>(counts[i] >> 8 & 0xff);
    data[3 + 2 * i] = static_cast<std::uint8_t>(counts[i] & 0xff);
  }
  return 10;
}

}  // namespace plvo_test
