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

namespace plvo_test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kHeader_bytes = 12;
constexpr std::size_t kDepthFrame_bytes = 640 * 480 * 11 / 8;
constexpr std::size_t kColourFrame_bytes = 640 * 480;
constexpr uid_t kNobody = 65534;
constexpr std::int64_t kPatience_frames = 15;
// How long a reap may wait for data: without it, libusb spins, for umockdev's device files always look ready.
constexpr auto kReapWait = std::chrono::milliseconds(2);

void put16(std::uint8_t* to, unsigned value) {
  to[0] = static_cast<std::uint8_t>(value & 0xff);
  to[1] = static_cast<std::uint8_t>(value >> 8 & 0xff);
}
unsigned get16(const std::uint8_t* from) { return from[0] | static_cast<unsigned>(from[1]) << 8; }
void put32(std::uint8_t* to, std::uint32_t value) {
  put16(to, value & 0xffff);
  put16(to + 2, value >> 16);
}

// One configuration, one interface, two isochronous endpoints of 2 × 960 bytes a microframe, as the Kinect
// has them.
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

std::string description(const std::string& sysfs, const std::string& node, int address,
                        const std::vector<std::uint8_t>& descriptors) {
  std::string hex;
  for (const std::uint8_t byte : descriptors) {
    char text[3];
    std::snprintf(text, sizeof(text), "%02X", byte);
    hex += text;
  }
  const std::string number = std::to_string(address);
  return "P: " + sysfs.substr(4) + "\nN: " + node.substr(5) +
         "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: DEVNAME=" + node +
         "\nE: BUSNUM=1\nE: DEVNUM=" + number + "\nA: busnum=1\nA: devnum=" + number +
         "\nA: bConfigurationValue=1\nA: speed=480\nH: descriptors=" + hex + "\n\n";
}

void add(UMockdevTestbed* testbed, const std::string& text) {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed, text.c_str(), &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
}

std::string node_of(int address) {
  char text[32];
  std::snprintf(text, sizeof(text), "/dev/bus/usb/001/%03d", address);
  return text;
}

}  // namespace

std::uint16_t SimulatedKinect::disparity(int picture, int x, int y) {
  if ((x / 16 + y / 16 + picture) % 11 == 0) return 2047;
  return static_cast<std::uint16_t>(400 + (x / 4 + y / 2 + picture * 37) % 600);
}

std::uint8_t SimulatedKinect::bayer(int picture, int x, int y) {
  return static_cast<std::uint8_t>(x * 5 + y * 3 + picture * 50 + (x & 1) * 20 + (y & 1) * 90);
}

SimulatedKinect::SimulatedKinect() : testbed_(umockdev_testbed_new()) {
  depth_pictures_.assign(kDepthFrame_bytes * kPictures, 0);
  colour_pictures_.resize(kColourFrame_bytes * kPictures);
  for (int p = 0; p < kPictures; ++p) {
    std::uint8_t* packed = depth_pictures_.data() + static_cast<std::size_t>(p) * kDepthFrame_bytes;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto pixel = static_cast<std::size_t>(y * kWidth + x);
        colour_pictures_[static_cast<std::size_t>(p) * kColourFrame_bytes + pixel] = bayer(p, x, y);
        for (std::size_t bit = 0; bit < 11; ++bit) {  // most significant bit first, pixel after pixel
          if ((disparity(p, x, y) >> (10 - bit) & 1) == 0) continue;
          const std::size_t at = pixel * 11 + bit;
          packed[at / 8] = static_cast<std::uint8_t>(packed[at / 8] | 0x80 >> at % 8);
        }
      }
    }
  }
  const std::string root = "/sys/devices/pci0000:00/usb1";
  add(testbed_, description(root, node_of(1), 1, hub_descriptors()));
  hub_ = root + "/1-1";
  add(testbed_, description(hub_, node_of(2), 2, hub_descriptors()));
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
  node_ = node_of(address_);
  add(testbed_, description(sysfs_, node_, address_, camera_descriptors()));
  if (handler_ != nullptr) g_object_unref(handler_);
  handler_ = umockdev_ioctl_base_new();
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&SimulatedKinect::on_ioctl), this);
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed_, node_.c_str(), handler_, &error) == FALSE) {
    throw std::runtime_error(error->message);
  }
  umockdev_testbed_uevent(testbed_, sysfs_.c_str(), "add");
}

// What is under way comes back as shut down, everything after it finds no device; the handler stays for both.
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
  // Tests often run as root, who may everything: this thread becomes nobody, and all else in the mock is
  // opened wide.
  ::nftw(
      root,
      [](const char* name, const struct stat*, int type, FTW*) {
        return type == FTW_SL ? 0 : ::chmod(name, 0777);
      },
      16, FTW_PHYS);
  const std::string path = std::string(root) + node_;
  ::chmod(path.c_str(), 0);
  g_free(root);
  ::setfsuid(kNobody);
}

void SimulatedKinect::allow() { ::setfsuid(::geteuid()); }

void SimulatedKinect::set_faults(const Faults& faults) {
  const std::lock_guard lock(mutex_);
  faults_ = faults;
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
  return EINVAL;  // it is done already
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
    // The stream whose data has been ready for longest goes first, so that a slow machine starves neither.
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

void SimulatedKinect::fill(IsoStream& stream, usbdevfs_urb& urb) {
  auto* to = static_cast<std::uint8_t*>(urb.buffer);
  for (int i = 0; i < urb.number_of_packets; ++i) {
    usbdevfs_iso_packet_desc& packet = urb.iso_frame_desc[i];
    packet.actual_length = 0;
    packet.status = 0;
    if (static_cast<int>(packet.length) >= stream.packet_bytes) {
      const auto hit = [&](int every) { return every > 0 && packets_ % static_cast<unsigned>(every) == 0; };
      ++packets_;
      packet.actual_length = static_cast<unsigned>(write_packet(stream, to));
      if (hit(faults_.corrupt_every)) std::memset(to, 0xa5, kHeader_bytes);
      if (hit(faults_.lose_every)) packet.actual_length = 0;
      if (hit(faults_.error_every)) packet.status = static_cast<unsigned>(-EILSEQ);
      const bool stopped = stream.endpoint == 0x81 ? faults_.colour_stops : faults_.depth_stops;
      if (stopped) packet.actual_length = 0;
    }
    to += packet.length;
  }
  urb.status = 0;
  urb.actual_length = urb.buffer_length;
  urb.error_count = 0;
}

int SimulatedKinect::write_packet(IsoStream& stream, std::uint8_t* to) {
  // A sensor does not wait for a machine that is too slow: frames that were due long ago are never sent. This
  // one is patient, for the machine also has the sensor itself to simulate.
  const std::int64_t late = (Clock::now() - due(stream, stream.sent)) / std::chrono::nanoseconds(kFrame_ns);
  if (stream.sent % stream.packets_per_frame == 0 && late > kPatience_frames) {
    stream.sent += late * stream.packets_per_frame;
    skipped_ += static_cast<std::uint64_t>(late);
  }
  const std::int64_t frame = stream.first_frame + stream.sent / stream.packets_per_frame;
  const auto index = static_cast<int>(stream.sent % stream.packets_per_frame);
  const std::size_t frame_bytes = stream.pictures->size() / kPictures;
  const auto payload = static_cast<std::size_t>(stream.packet_bytes - kHeader_bytes);
  const std::size_t offset = static_cast<std::size_t>(index) * payload;
  const std::size_t count = std::min(payload, frame_bytes - offset);
  const std::int64_t since_plug_ns = frame * kFrame_ns + stream.stamp_offset_ns;
  std::memset(to, 0, kHeader_bytes);
  to[0] = 'R';
  to[1] = 'B';
  to[3] = index == 0                              ? stream.flag_first
          : index + 1 == stream.packets_per_frame ? stream.flag_last
                                                  : stream.flag_middle;
  to[5] = static_cast<std::uint8_t>(stream.sent);
  put16(to + 6, static_cast<unsigned>(count));
  put32(to + 8, first_ticks_ + static_cast<std::uint32_t>(since_plug_ns * 3 / 50));  // 60 MHz
  const std::uint8_t* picture =
      stream.pictures->data() + static_cast<std::size_t>(frame % kPictures) * frame_bytes;
  std::memcpy(to + kHeader_bytes, picture + offset, count);
  ++stream.sent;
  return kHeader_bytes + static_cast<int>(count);
}

// Vendor request 0: OUT carries a command, IN fetches its reply. The client asks for the reply until it is
// there.
int SimulatedKinect::control(const std::uint8_t* setup, std::uint8_t* data, int length) {
  if (setup[0] == 0x40 && setup[1] == 0) {
    command(data, length);
    return length;
  }
  if (setup[0] == 0xc0 && setup[1] == 0) {
    const int count = std::min(length, static_cast<int>(reply_.size()));
    std::memcpy(data, reply_.data(), static_cast<std::size_t>(count));
    return count;
  }
  if (setup[0] == 0x80 && setup[1] == 6) {  // a string descriptor
    const std::uint8_t text[] = {10, 3, 'A', 0, '0', 0, '0', 0, '1', 0};
    const std::uint8_t languages[] = {4, 3, 9, 4};
    const bool list = setup[2] == 0;
    const int count = std::min<int>(length, list ? sizeof(languages) : sizeof(text));
    std::memcpy(data, list ? languages : text, static_cast<std::size_t>(count));
    return count;
  }
  return -EPIPE;
}

void SimulatedKinect::command(const std::uint8_t* request, int length) {
  if (length < 8 || request[0] != 0x47 || request[1] != 0x4d) {
    reply_.clear();
    return;
  }
  const unsigned verb = get16(request + 4);
  const auto argument = [&](int i) {
    return 8 + 2 * i + 2 <= length ? static_cast<int>(get16(request + 8 + 2 * i)) : 0;
  };
  std::vector<std::uint8_t> body;
  switch (verb) {
    case 0x02:  // read a register
      body.assign(4, 0);
      put16(body.data(), static_cast<unsigned>(argument(0)));
      put16(body.data() + 2, static_cast<unsigned>(registers_[argument(0)]));
      break;
    case 0x03:  // write a register
      set_register(argument(0), argument(1));
      body.assign(2, 0);
      break;
    case 0x04: {  // fixed parameters; four floats of the zero plane: 7.5 cm, 2.3 cm, 120 cm, 0.1042 mm
      body.assign(322, 0);
      const float zero_plane[4] = {7.5f, 2.3f, 120.0f, 0.1042f};
      std::memcpy(body.data() + 94, zero_plane, sizeof(zero_plane));
      break;
    }
    case 0x16:  // algorithm parameters; all zero but the constant shift: no distortion to be registered away
      body.assign(argument(0) == 0x40 ? 118 : argument(0) == 0x41 ? 8 : 4, 0);
      if (body.size() == 4) put16(body.data() + 2, 200);
      break;
    case 0x95:  // the CMOS sensor's register
      body.assign(6, 0);
      break;
    default: body.assign(2, 0); break;
  }
  reply_.assign(8, 0);
  reply_[0] = 0x52;
  reply_[1] = 0x42;
  put16(reply_.data() + 2, static_cast<unsigned>(body.size() / 2));
  std::memcpy(reply_.data() + 4, request + 4, 4);  // verb and tag
  reply_.insert(reply_.end(), body.begin(), body.end());
}

// Register 5 runs colour (1: on), 6 runs depth (2: on).
void SimulatedKinect::set_register(int number, int value) {
  registers_[number] = value;
  for (IsoStream& stream : streams_) {
    if (number != (stream.endpoint == 0x81 ? 0x05 : 0x06)) continue;
    const bool on = value != 0;
    if (on && !stream.on) {
      // Both sensors go by one clock: a stream starts with the next whole frame of it.
      const auto frames = (Clock::now() - plugged_) / std::chrono::nanoseconds(kFrame_ns) + 1;
      stream.first_frame = frames;
      stream.start = plugged_ + std::chrono::nanoseconds(frames * kFrame_ns);
      stream.sent = 0;
    }
    stream.on = on;
  }
}

}  // namespace plvo_test
