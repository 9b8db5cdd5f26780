// SPDX-License-Identifier: Apache-2.0
// Frames from the thread that captures to the thread that computes: a fixed number of slots, each with pixels
// of its own, all made by the constructor. The odometry wants the newest frame: what it had no time for is
// dropped and counted. Who must have every frame (a recorder, a test) takes them in order, and the producer
// may wait for room.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "plvo/host/frame_copy.hpp"

namespace plvo {

enum class RingPolicy : std::uint8_t {
  kNewest,   // take() gives the newest frame, older ones are dropped
  kInOrder,  // take() gives the oldest frame; push() drops the oldest one when there is no room
  kEvery,    // take() gives the oldest frame; push() waits for room
};

class FrameRing {
 public:
  struct Counters {
    std::uint64_t pushed = 0;
    std::uint64_t taken = 0;
    std::uint64_t dropped = 0;
    std::uint64_t refused = 0;  // of another size than the ring's
  };
  enum class Take : std::uint8_t { kFrame, kTimeout, kClosed };

  // Frames of up to width × height pixels, three bytes a pixel and depth. slots ≥ 3: one being written, one
  // being read, one ready.
  FrameRing(int width, int height, std::size_t slots, RingPolicy policy);

  // The capture thread. Copies the pixels; arrival_ns is when the frame came, for the latency. False when the
  // frame is larger than a slot, or the ring was closed while waiting.
  bool push(const RgbdFrame& frame, std::int64_t arrival_ns);
  // No more frames will come. What lies ready can still be taken.
  void close();

  // The computing thread. The views in `frame` stay valid until the next take().
  Take take(RgbdFrame& frame, std::int64_t& arrival_ns, int timeout_ms);

  Counters counters() const;

 private:
  struct Slot {
    FrameCopy copy;
    std::int64_t arrival_ns = 0;
  };
  std::size_t pop_ready();

  const std::size_t pixels_;
  const RingPolicy policy_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> free_;   // a stack
  std::vector<std::size_t> ready_;  // a circle of indices, oldest at first_
  std::size_t first_ = 0;
  std::size_t ready_count_ = 0;
  std::size_t reading_;  // the slot that the reader holds, or slots_.size()
  bool closed_ = false;
  Counters counters_;
  mutable std::mutex mutex_;
  std::condition_variable frame_ready_;
  std::condition_variable slot_free_;
};

}  // namespace plvo
