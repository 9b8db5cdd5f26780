// SPDX-License-Identifier: Apache-2.0
#include "plvo/usb/usb_bus.hpp"

#include <libusb.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace plvo {
namespace {

int to_mbps(int speed) {
  switch (speed) {
    case LIBUSB_SPEED_LOW: return 1;
    case LIBUSB_SPEED_FULL: return 12;
    case LIBUSB_SPEED_HIGH: return 480;
    case LIBUSB_SPEED_SUPER: return 5000;
    case LIBUSB_SPEED_SUPER_PLUS: return 10000;
    default: return 0;
  }
}

std::string node_name(int bus, int address) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03d/%03d", bus, address);
  return text.data();
}

const KnownUsbDevice* identify(libusb_device* device, libusb_device_descriptor& descriptor) {
  if (libusb_get_device_descriptor(device, &descriptor) != 0) return nullptr;
  return find_known(descriptor.idVendor, descriptor.idProduct);
}

}  // namespace

std::string port_name(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string name = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) {
    name += (i == 0 ? '-' : '.');
    name += std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return name;
}

struct UsbBus::Watch {
  std::array<libusb_hotplug_callback_handle, 8> handles{};
  std::size_t handle_count = 0;
  std::vector<UsbEvent> events;

  static int LIBUSB_CALL on_event(libusb_context*, libusb_device* device, libusb_hotplug_event event,
                                  void* user) {
    libusb_device_descriptor descriptor{};
    const KnownUsbDevice* known = identify(device, descriptor);
    if (known == nullptr) return 0;
    const auto kind =
        event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED ? UsbEvent::Kind::kArrived : UsbEvent::Kind::kLeft;
    static_cast<Watch*>(user)->events.push_back({kind, *known, port_name(device)});
    return 0;
  }
};

UsbBus::UsbBus() = default;

UsbBus::~UsbBus() {
  if (context_ == nullptr) return;
  if (watch_) {
    for (std::size_t i = 0; i < watch_->handle_count; ++i) {
      libusb_hotplug_deregister_callback(context_, watch_->handles[i]);
    }
  }
  libusb_exit(context_);
}

Status UsbBus::open() {
  if (context_ != nullptr) return {};
  const int error = libusb_init(&context_);
  if (error == 0) return {};
  context_ = nullptr;
  return Status(StatusCode::kIo, "libusb cannot start: ").append(libusb_strerror(error));
}

std::vector<UsbDeviceFacts> UsbBus::list() const {
  std::vector<UsbDeviceFacts> found;
  libusb_device** devices = nullptr;
  const ssize_t count = context_ != nullptr ? libusb_get_device_list(context_, &devices) : 0;
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    const KnownUsbDevice* known = identify(devices[i], descriptor);
    if (known == nullptr) continue;
    UsbDeviceFacts facts;
    facts.known = *known;
    facts.bcd = descriptor.bcdDevice;
    facts.bus = libusb_get_bus_number(devices[i]);
    facts.address = libusb_get_device_address(devices[i]);
    facts.port = port_name(devices[i]);
    facts.node = node_name(facts.bus, facts.address);
    facts.speed_mbps = to_mbps(libusb_get_device_speed(devices[i]));
    found.push_back(std::move(facts));
  }
  if (devices != nullptr) libusb_free_device_list(devices, 1);
  std::sort(found.begin(), found.end(), [](const UsbDeviceFacts& a, const UsbDeviceFacts& b) {
    return std::pair(a.port, a.address) < std::pair(b.port, b.address);
  });
  return found;
}

bool UsbBus::camera_present() const {
  for (const UsbDeviceFacts& device : list()) {
    if (device.known.part == SensorPart::kCamera) return true;
  }
  return false;
}

Status UsbBus::watch() {
  if (context_ == nullptr) return {StatusCode::kInvalidArgument, "UsbBus::open() comes before watch()"};
  if (watch_) return {};
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) {
    return {StatusCode::kUnsupported, "this libusb has no hot-plug events on this system"};
  }
  watch_ = std::make_unique<Watch>();
  std::vector<std::uint16_t> vendors;
  for (const KnownUsbDevice& known : known_usb_devices()) {
    if (std::find(vendors.begin(), vendors.end(), known.vendor) == vendors.end())
      vendors.push_back(known.vendor);
  }
  for (std::uint16_t vendor : vendors) {
    const int error = libusb_hotplug_register_callback(
        context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0, vendor,
        LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, &Watch::on_event, watch_.get(),
        &watch_->handles[watch_->handle_count]);
    if (error != 0) return Status(StatusCode::kIo, "libusb hot-plug: ").append(libusb_strerror(error));
    ++watch_->handle_count;
  }
  return {};
}

std::vector<UsbEvent> UsbBus::poll(int timeout_ms) {
  if (!watch_) return {};
  if (watch_->events.empty()) {
    timeval limit{timeout_ms / 1000, (timeout_ms % 1000) * 1000};
    libusb_handle_events_timeout_completed(context_, &limit, nullptr);
  }
  return std::exchange(watch_->events, {});
}

}  // namespace plvo
