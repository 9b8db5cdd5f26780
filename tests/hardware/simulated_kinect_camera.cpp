// SPDX-License-Identifier: Apache-2.0
// The camera of the simulated Kinect: its images, its packets and its commands.
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "simulated_kinect.hpp"

namespace plvo_test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kHeader_bytes = 12;
constexpr std::size_t kDepthFrame_bytes = SimulatedKinect::kPixels * 11 / 8;
constexpr std::int64_t kPatience_frames = 15;

void put16(std::uint8_t* to, unsigned value) {
  to[0] = static_cast<std::uint8_t>(value & 0xff);
  to[1] = static_cast<std::uint8_t>(value >> 8 & 0xff);
}
unsigned get16(const std::uint8_t* from) { return from[0] | static_cast<unsigned>(from[1]) << 8; }
void put32(std::uint8_t* to, std::uint32_t value) {
  put16(to, value & 0xffff);
  put16(to + 2, value >> 16);
}

}  // namespace

std::uint16_t SimulatedKinect::disparity(int picture, int x, int y) {
  if ((x / 16 + y / 16 + picture) % 11 == 0) return 2047;
  return static_cast<std::uint16_t>(400 + (x / 4 + y / 2 + picture * 37) % 600);
}

std::uint8_t SimulatedKinect::bayer(int picture, int x, int y) {
  return static_cast<std::uint8_t>(x * 5 + y * 3 + picture * 50 + (x & 1) * 20 + (y & 1) * 90);
}

void SimulatedKinect::set_pictures(const std::vector<std::uint16_t>& disparities,
                                   const std::vector<std::uint8_t>& mosaics) {
  colour_pictures_ = mosaics;
  depth_pictures_.assign(kDepthFrame_bytes * kPictures, 0);
  for (std::size_t p = 0; p < kPictures; ++p) {
    std::uint8_t* packed = depth_pictures_.data() + p * kDepthFrame_bytes;
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      for (std::size_t bit = 0; bit < 11; ++bit) {  // most significant bit first, pixel after pixel
        if ((disparities[p * kPixels + pixel] >> (10 - bit) & 1) == 0) continue;
        const std::size_t at = pixel * 11 + bit;
        packed[at / 8] = static_cast<std::uint8_t>(packed[at / 8] | 0x80 >> at % 8);
      }
    }
  }
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
  // A real sensor does not wait for a slow machine: overdue frames are never sent. This one tolerates a
  // longer delay, because the machine also simulates the sensor.
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

// Vendor request 0: OUT carries a command, IN fetches its reply. The client asks until the reply is ready.
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
    case 0x16:  // algorithm parameters; all zero except the constant shift: registration has no distortion
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
      // Both sensors use the same clock: a stream starts with its next whole frame.
      const auto frames = (Clock::now() - plugged_) / std::chrono::nanoseconds(kFrame_ns) + 1;
      stream.first_frame = frames;
      stream.start = plugged_ + std::chrono::nanoseconds(frames * kFrame_ns);
      stream.sent = 0;
    }
    stream.on = on;
  }
}

}  // namespace plvo_test
