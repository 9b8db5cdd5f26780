// SPDX-License-Identifier: Apache-2.0
#include "mock_usb.hpp"

#include <fcntl.h>
#include <ftw.h>
#include <linux/usbdevice_fs.h>
#include <sys/fsuid.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace plvo {
namespace {

constexpr uid_t kInvalidSlot = 65534;

// A device with one configuration, one vendor-specific interface and one bulk endpoint in each direction.
std::vector<std::uint8_t> descriptors(const MockDeviceSpec& s) {
  const auto low = [](std::uint16_t v) { return static_cast<std::uint8_t>(v & 0xff); };
  const auto high = [](std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); };
  return {18,
          1,
          0x00,
          0x02,
          0,
          0,
          0,
          64,
          low(s.vendor),
          high(s.vendor),
          low(s.product),
          high(s.product),
          low(s.bcd),
          high(s.bcd),
          0,
          0,
          0,
          1,
          9,
          2,
          32,
          0,
          1,
          1,
          0,
          0x80,
          50,
          9,
          4,
          0,
          0,
          2,
          0xff,
          0,
          0,
          0,
          7,
          5,
          0x01,
          2,
          0x00,
          0x02,
          0,
          7,
          5,
          0x81,
          2,
          0x00,
          0x02,
          0};
}

std::string node_of(const MockDeviceSpec& spec) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03d/%03d", spec.bus, spec.address);
  return text.data();
}

// The device on port "1-1.3" has its directory in …/usb1/1-1/.
std::string parent_folder(const std::string& port) {
  const std::string top = "/sys/devices/pci0000:00/";
  if (port.rfind("usb", 0) == 0) return top;
  const std::size_t dot = port.find_last_of('.');
  if (dot == std::string::npos) return top + "usb" + port.substr(0, port.find('-')) + "/";
  const std::string hub = port.substr(0, dot);
  return parent_folder(hub) + hub + "/";
}

}  // namespace

struct MockUsb::Device {
  MockDeviceSpec spec;
  MockBehaviour behaviour;
  std::string sysfs;
  std::string interface_sysfs;
  UMockdevIoctlBase* handler = nullptr;
  std::mutex mutex;
  std::deque<usbdevfs_urb*> done;
};

// A root hub and the Kinect's own hub on port 1: libusb derives the name of a port from the hubs above it.
MockUsb::MockUsb() : testbed_(umockdev_testbed_new()) {
  plug({"usb1", 1, 1, 0x1d6b, 0x0002});
  plug({"1-1", 1, 2, 0x0409, 0x005a});
}

MockUsb::~MockUsb() {
  for (auto& [port, device] : devices_) g_object_unref(device->handler);
  g_object_unref(testbed_);
}

void MockUsb::plug(const MockDeviceSpec& spec, MockBehaviour behaviour) {
  auto device = std::make_unique<Device>();
  device->spec = spec;
  device->behaviour = std::move(behaviour);
  const std::string node = node_of(spec);
  const std::vector<std::uint8_t> bytes = descriptors(spec);
  std::string hex;
  for (std::uint8_t byte : bytes) {
    std::array<char, 3> text{};
    std::snprintf(text.data(), text.size(), "%02X", byte);
    hex += text.data();
  }
  const std::string number = std::to_string(spec.bus);
  device->sysfs = parent_folder(spec.port) + spec.port;
  const std::string description = "P: " + device->sysfs.substr(4) + "\nN: " + node.substr(5) +
                                  "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DEVNAME=" + node +
                                  "\nE: BUSNUM=" + number + "\nE: DEVNUM=" + std::to_string(spec.address) +
                                  "\nA: busnum=" + number + "\nA: devnum=" + std::to_string(spec.address) +
                                  "\nA: bConfigurationValue=1\nA: speed=" + spec.speed +
                                  "\nH: descriptors=" + hex + "\n\n";
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, description.c_str(), &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  if (spec.kernel_driver != nullptr) {
    gchar* path =
        umockdev_testbed_add_device(testbed_, "usb", (spec.port + ":1.0").c_str(), device->sysfs.c_str(),
                                    "bInterfaceNumber", "00", nullptr, "DEVTYPE", "usb_interface", nullptr);
    device->interface_sysfs = path;
    const std::string link = std::string("/sys/bus/usb/drivers/") + spec.kernel_driver;
    umockdev_testbed_set_attribute_link(testbed_, path, "driver", link.c_str());
    g_free(path);
  }
  device->handler = umockdev_ioctl_base_new();
  g_signal_connect(device->handler, "handle-ioctl", G_CALLBACK(&MockUsb::on_ioctl), device.get());
  if (umockdev_testbed_attach_ioctl(testbed_, node.c_str(), device->handler, &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  umockdev_testbed_uevent(testbed_, device->sysfs.c_str(), "add");
  devices_[spec.port] = std::move(device);
}

void MockUsb::unplug(const std::string& port) {
  Device& device = *devices_.at(port);
  umockdev_testbed_detach_ioctl(testbed_, node_of(device.spec).c_str(), nullptr);
  umockdev_testbed_uevent(testbed_, device.sysfs.c_str(), "remove");
  if (!device.interface_sysfs.empty())
    umockdev_testbed_remove_device(testbed_, device.interface_sysfs.c_str());
  umockdev_testbed_remove_device(testbed_, device.sysfs.c_str());
  g_object_unref(device.handler);
  devices_.erase(port);
}

void MockUsb::deny(const std::string& port) {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  const std::string path = std::string(root) + node_of(devices_.at(port)->spec);
  // All other files stay accessible to the user that the thread becomes: umockdev's own sockets are there
  // too.
  ::nftw(
      root,
      [](const char* name, const struct stat*, int type, FTW*) {
        return type == FTW_SL ? 0 : ::chmod(name, 0777);
      },
      16, FTW_PHYS);
  ::chmod(path.c_str(), 0);
  g_free(root);
  ::setfsuid(kInvalidSlot);
}

void MockUsb::set_usbfs_memory(int megabytes) {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  std::string path(root);
  g_free(root);
  for (const char* part : {"/sys", "/module", "/usbcore", "/parameters"})
    ::mkdir((path += part).c_str(), 0755);
  if (std::FILE* file = std::fopen((path + "/usbfs_memory_mb").c_str(), "w"); file != nullptr) {
    std::fprintf(file, "%d\n", megabytes);
    std::fclose(file);
  }
}

gboolean MockUsb::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  Device& device = *static_cast<Device*>(user);
  UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  void* pointer = nullptr;
  std::memcpy(&pointer, arg->data, sizeof pointer);
  const std::lock_guard lock(device.mutex);
  long result = 0;
  int error = 0;
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(pointer) = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_ZERO_PACKET;
      break;
    case USBDEVFS_CLAIMINTERFACE: error = device.behaviour.claim_errno; break;
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_DISCONNECT_CLAIM: break;
    case USBDEVFS_GETDRIVER: error = ENODATA; break;
    case USBDEVFS_SUBMITURB: {
      auto* urb = static_cast<usbdevfs_urb*>(pointer);
      auto* buffer = static_cast<std::uint8_t*>(urb->buffer);
      int moved = -EPIPE;
      if (urb->type == USBDEVFS_URB_TYPE_CONTROL && device.behaviour.control) {
        moved = device.behaviour.control(buffer, buffer + 8, urb->buffer_length - 8);
      } else if (urb->type == USBDEVFS_URB_TYPE_BULK && device.behaviour.bulk) {
        moved = device.behaviour.bulk(urb->endpoint, buffer, urb->buffer_length);
      }
      urb->status = moved < 0 ? moved : 0;
      urb->actual_length = moved < 0 ? 0 : moved;
      device.done.push_back(urb);
      break;
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      if (device.done.empty()) {
        error = EAGAIN;
      } else {
        *static_cast<usbdevfs_urb**>(pointer) = device.done.front();
        device.done.pop_front();
      }
      break;
    default: error = ENOTTY; break;
  }
  umockdev_ioctl_client_complete(client, error != 0 ? -1 : result, error);
  return TRUE;
}

}  // namespace plvo
