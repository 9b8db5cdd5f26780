// SPDX-License-Identifier: Apache-2.0
// A Kinect v1 on a simulated USB bus: umockdev answers for /sys, /dev and the ioctls of usbfs, and this class
// plays the device at the other end of the cable. The camera speaks the protocol that the OpenKinect project
// documented: control commands, and isochronous packets of depth (11 bits packed) and colour (Bayer GRBG).
// Runs under umockdev-wrapper with simulator and client in one process, so that it can dereference the
// pointers in an ioctl.
#pragma once

#include <umockdev.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

struct usbdevfs_urb;

namespace plvo_test {

class SimulatedKinect {
 public:
  static constexpr int kWidth = 640;
  static constexpr int kHeight = 480;
  static constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
  static constexpr int kPictures = 4;  // frame n shows picture n mod kPictures
  static constexpr std::int64_t kFrame_ns = 33333333;
  static constexpr std::int64_t kDepthOffset_ns = 5000000;  // offset of the depth stamps from those of colour

  // One image of the camera: 11-bit disparity (2047: no depth) and the Bayer mosaic.
  static std::uint16_t disparity(int picture, int x, int y);
  static std::uint8_t bayer(int picture, int x, int y);

  struct Faults {
    int lose_every = 0;     // every n-th packet is lost
    int corrupt_every = 0;  // every n-th packet has a corrupt header
    int error_every = 0;    // every n-th packet arrives with a bus error
    bool colour_stops = false;
    bool depth_stops = false;
    int claim_errno = 0;  // e.g. EBUSY: another program uses the camera
  };

  SimulatedKinect();
  ~SimulatedKinect();
  SimulatedKinect(const SimulatedKinect&) = delete;
  SimulatedKinect& operator=(const SimulatedKinect&) = delete;

  // Replaces the images by these, shown in turn. Call it before the first plug().
  void set_pictures(const std::vector<std::uint16_t>& disparities, const std::vector<std::uint8_t>& mosaics);

  // Plugs the device into port 1-1.3 with a new address each time; ticks: initial value of the camera's 60
  // MHz clock.
  void plug(std::uint32_t ticks = 1000);
  void unplug();
  // After this call, this thread and the threads it starts may not open the camera. allow() undoes it.
  void deny();
  void allow();
  void set_faults(const Faults& faults);
  // Time on steady_clock at which the camera's clock showed this value, up to multiples of its 32-bit range.
  std::int64_t host_ns(std::int64_t stamp_ns) const;
  // The bus and the Kinect's own hub on it, to which other devices attach.
  UMockdevTestbed* testbed() { return testbed_; }
  const std::string& hub() const { return hub_; }
  // Frames of either stream that were not sent because this machine was too slow for simulator and client
  // together.
  std::uint64_t skipped() const;

 private:
  struct IsoStream {
    unsigned endpoint = 0;
    std::uint8_t flag_first = 0, flag_middle = 0, flag_last = 0;
    int packet_bytes = 0;
    int packets_per_frame = 0;
    const std::vector<std::uint8_t>* pictures = nullptr;
    std::int64_t stamp_offset_ns = 0;
    bool on = false;
    std::chrono::steady_clock::time_point start;
    std::int64_t first_frame = 0;  // on the camera's clock, at start: both streams count frames alike
    std::int64_t sent = 0;         // packets since start
    std::deque<usbdevfs_urb*> waiting;
  };

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user);
  int submit(usbdevfs_urb& urb);
  int discard(usbdevfs_urb* urb);
  usbdevfs_urb* reap(std::unique_lock<std::mutex>& lock, int& error);
  int control(const std::uint8_t* setup, std::uint8_t* data, int length);
  void command(const std::uint8_t* request, int length);
  void set_register(int number, int value);
  void fill(IsoStream& stream, usbdevfs_urb& urb);
  int write_packet(IsoStream& stream, std::uint8_t* to);
  std::chrono::steady_clock::time_point due(const IsoStream& stream, std::int64_t packet) const;
  std::string describe(const std::string& sysfs, const std::string& node, int address) const;

  UMockdevTestbed* testbed_ = nullptr;
  UMockdevIoctlBase* handler_ = nullptr;
  std::string sysfs_;
  std::string node_;
  int address_ = 3;
  std::string hub_;

  mutable std::mutex mutex_;
  bool gone_ = true;
  Faults faults_;
  std::uint32_t first_ticks_ = 0;
  std::chrono::steady_clock::time_point plugged_;
  std::array<IsoStream, 2> streams_;
  std::deque<usbdevfs_urb*> done_;
  std::vector<std::uint8_t> reply_;
  std::map<int, int> registers_;
  std::uint64_t packets_ = 0;
  std::uint64_t skipped_ = 0;
  std::vector<std::uint8_t> depth_pictures_;
  std::vector<std::uint8_t> colour_pictures_;
};

}  // namespace plvo_test
