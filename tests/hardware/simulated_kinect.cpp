// SPDX-License-Identifier: Apache-2.0
#include "simulated_kinect.hpp"

#include <fcntl.h>
#include <ftw.h>
#include <linux/usbdevice_fs.h>
#include <sys/fsuid.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "simulated_usb.hpp"

namespace plvo_test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uid_t kInvalidSlot = 65534;
// How long a reap may wait for data. Without the wait, libusb busy-loops, because umockdev's device files
// always appear ready.
constexpr auto kReapWait = std::chrono::milliseconds(2);

// Descriptors of the Kinect: one configuration, one interface, two isochronous endpoints of 2 × 960 bytes a
// microframe.
std::vector<std::uint8_t> camera_descriptors() {
  return {18, 1, 0x00, 0x02, 0,    0,    0,    64,   0x5e, 0x04, 0xae, 0x02, 0x0b, 0x01, 0, 0, 0, 1,  //
          9,  2, 32,   0,    1,    1,    0,    0xc0, 8,                                               //
          9,  4, 0,    0,    2,    0xff, 0xff, 0xff, 0,                                               //
          7,  5, 0x81, 0x01, 0xc0, 0x0b, 1,                                                           //
          7,  5, 0x82, 0x01, 0xc0, 0x0b, 1};
}
std::vector<std::uint8_t> hub_descriptors() {
  return {18, 1, 0x00, 0x02, 9, 0, 1, 64,   0x09, 0x04, 0x5a, 0x00, 0, 1, 0, 0, 0, 1,  //
          9,  2, 25,   0,    1, 1, 0, 0xe0, 0,                                         //
          9,  4, 0,    0,    1, 9, 0, 0,    0,                                         //
          7,  5, 0x81, 3,    1, 0, 12};
}

}  // namespace

SimulatedKinect::SimulatedKinect() : testbed_(umockdev_testbed_new()) {
  std::vector<std::uint16_t> disparities(kPictures * kPixels);
  std::vector<std::uint8_t> mosaics(kPictures * kPixels);
  for (int p = 0; p < kPictures; ++p) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(p) * kPixels + static_cast<std::size_t>(y * kWidth + x);
        disparities[at] = disparity(p, x, y);
        mosaics[at] = bayer(p, x, y);
      }
    }
  }
  set_pictures(disparities, mosaics);
  const std::string root = "/sys/devices/pci0000:00/usb1";
  add_to_testbed(testbed_, usb_description(root, usb_node(1), 1, hub_descriptors()));
  hub_ = root + "/1-1";
  add_to_testbed(testbed_, usb_description(hub_, usb_node(2), 2, hub_descriptors()));
}

SimulatedKinect::~SimulatedKinect() {
  allow();
  if (!gone_) unplug();
  if (handler_ != nullptr) g_object_unref(handler_);
  g_object_unref(testbed_);
}

void SimulatedKinect::plug(std::uint32_t ticks) {
  {
    const std::lock_guard lock(mutex_);
    gone_ = false;
    first_ticks_ = ticks;
    plugged_ = Clock::now();
    streams_[0] = IsoStream{};
    streams_[1] = IsoStream{};
    IsoStream& colour = streams_[0];
    colour.endpoint = 0x81;
    colour.flag_first = 0x81;
    colour.flag_middle = 0x82;
    colour.flag_last = 0x85;
    colour.packet_bytes = 1920;
    colour.packets_per_frame = 162;
    colour.pictures = &colour_pictures_;
    IsoStream& depth = streams_[1];
    depth.endpoint = 0x82;
    depth.flag_first = 0x71;
    depth.flag_middle = 0x72;
    depth.flag_last = 0x75;
    depth.packet_bytes = 1760;
    depth.packets_per_frame = 242;
    depth.pictures = &depth_pictures_;
    depth.stamp_offset_ns = kDepthOffset_ns;
    done_.clear();
    reply_.clear();
  }
  ++address_;
  sysfs_ = hub_ + "/1-1.3";
  node_ = usb_node(address_);
  add_to_testbed(testbed_, usb_description(sysfs_, node_, address_, camera_descriptors()));
  if (handler_ != nullptr) g_object_unref(handler_);
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&SimulatedKinect::on_ioctl), this);
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed_, node_.c_str(), handler_, &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  umockdev_testbed_uevent(testbed_, sysfs_.c_str(), "add");
}

// Pending transfers return as shut down, and later calls find no device. The handler stays for both.
void SimulatedKinect::unplug() {
  {
    const std::lock_guard lock(mutex_);
    gone_ = true;
    for (IsoStream& stream : streams_) {
      for (usbdevfs_urb* urb : stream.waiting) {
        urb->status = -ESHUTDOWN;
        done_.push_back(urb);
      }
      stream.waiting.clear();
      stream.on = false;
    }
  }
  umockdev_testbed_uevent(testbed_, sysfs_.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, sysfs_.c_str());
}

void SimulatedKinect::deny() {
  gchar* root = umockdev_testbed_get_root_dir(testbed_);
  // Tests often run as root, who has all permissions: this thread becomes an unprivileged user, and the rest
  // of the mock is made accessible to it.
  ::nftw(
      root,
      [](const char* name, const struct stat*, int type, FTW*) {
        return type == FTW_SL ? 0 : ::chmod(name, 0777);
      },
      16, FTW_PHYS);
  const std::string path = std::string(root) + node_;
  ::chmod(path.c_str(), 0);
  g_free(root);
  ::setfsuid(kInvalidSlot);
}

void SimulatedKinect::allow() { ::setfsuid(::geteuid()); }

void SimulatedKinect::set_faults(const Faults& faults) {
  const std::lock_guard lock(mutex_);
  faults_ = faults;
}

std::int64_t SimulatedKinect::host_ns(std::int64_t stamp_ns) const {
  const std::lock_guard lock(mutex_);
  const auto plugged = std::chrono::duration_cast<std::chrono::nanoseconds>(plugged_.time_since_epoch());
  return plugged.count() + stamp_ns - static_cast<std::int64_t>(first_ticks_) * 50 / 3;
}

std::uint64_t SimulatedKinect::skipped() const {
  const std::lock_guard lock(mutex_);
  return skipped_;
}

gboolean SimulatedKinect::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& self = *static_cast<SimulatedKinect*>(user);
  const UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  void* pointer = nullptr;
  std::memcpy(&pointer, arg->data, sizeof(pointer));
  std::unique_lock lock(self.mutex_);
  int error = 0;
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(pointer) = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_ZERO_PACKET;
      break;
    case USBDEVFS_CLAIMINTERFACE: error = self.gone_ ? ENODEV : self.faults_.claim_errno; break;
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_IOCTL: error = self.gone_ ? ENODEV : 0; break;
    case USBDEVFS_GETDRIVER: error = ENODATA; break;
    case USBDEVFS_SUBMITURB:
      error = self.gone_ ? ENODEV : self.submit(*static_cast<usbdevfs_urb*>(pointer));
      break;
    case USBDEVFS_DISCARDURB: error = self.discard(static_cast<usbdevfs_urb*>(pointer)); break;
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      if (usbdevfs_urb* urb = self.reap(lock, error); urb != nullptr)
        *static_cast<usbdevfs_urb**>(pointer) = urb;
      break;
    default: error = ENOTTY; break;
  }
  umockdev_ioctl_client_complete(client, error != 0 ? -1 : 0, error);
  return TRUE;
}

int SimulatedKinect::submit(usbdevfs_urb& urb) {
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    auto* buffer = static_cast<std::uint8_t*>(urb.buffer);
    const int moved = control(buffer, buffer + 8, urb.buffer_length - 8);
    urb.status = moved < 0 ? moved : 0;
    urb.actual_length = std::max(moved, 0);
    done_.push_back(&urb);
    return 0;
  }
  for (IsoStream& stream : streams_) {
    if (urb.type == USBDEVFS_URB_TYPE_ISO && urb.endpoint == stream.endpoint) {
      stream.waiting.push_back(&urb);
      return 0;
    }
  }
  return EINVAL;
}

int SimulatedKinect::discard(usbdevfs_urb* urb) {
  for (IsoStream& stream : streams_) {
    const auto at = std::find(stream.waiting.begin(), stream.waiting.end(), urb);
    if (at == stream.waiting.end()) continue;
    stream.waiting.erase(at);
    urb->status = -ENOENT;
    done_.push_back(urb);
    return 0;
  }
  return EINVAL;  // it is already complete
}

usbdevfs_urb* SimulatedKinect::reap(std::unique_lock<std::mutex>& lock, int& error) {
  for (const auto give_up = Clock::now() + kReapWait;;) {
    if (!done_.empty()) {
      usbdevfs_urb* urb = done_.front();
      done_.pop_front();
      return urb;
    }
    if (gone_) {
      error = ENODEV;
      return nullptr;
    }
    // The stream whose data have been ready for the longest time goes first, so that a slow machine starves
    // neither.
    auto next = Clock::time_point::max();
    IsoStream* first = nullptr;
    for (IsoStream& stream : streams_) {
      if (!stream.on || stream.waiting.empty()) continue;
      const auto ready = due(stream, stream.sent + stream.waiting.front()->number_of_packets);
      if (ready >= next) continue;
      next = ready;
      first = &stream;
    }
    if (first != nullptr && next <= Clock::now()) {
      usbdevfs_urb* urb = first->waiting.front();
      first->waiting.pop_front();
      fill(*first, *urb);
      return urb;
    }
    error = EAGAIN;
    if (next > give_up) next = give_up;
    if (Clock::now() >= give_up) return nullptr;
    lock.unlock();
    std::this_thread::sleep_until(next);
    lock.lock();
    error = 0;
  }
}

std::chrono::steady_clock::time_point SimulatedKinect::due(const IsoStream& stream,
                                                           std::int64_t packet) const {
  return stream.start + std::chrono::nanoseconds(packet * kFrame_ns / stream.packets_per_frame);
}

}  // namespace plvo_test
