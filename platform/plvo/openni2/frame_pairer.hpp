// SPDX-License-Identifier: Apache-2.0
// Colour and depth joined by time. Each stream writes into its own fixed buffers; the oldest colour and the
// oldest depth whose stamps differ by no more than the tolerance are a pair. With a tolerance of half a frame
// at most (the caller sees to that) no later image can fit better, so nothing waits for one. An image that
// can find no partner any more is counted and its buffer used again. Memory is taken in reset() and never
// after.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace plvo {

class FramePairer {
 public:
  // How late one stream may run behind the other: kSlots - 1 frames (230 ms at 30 Hz).
  static constexpr std::size_t kSlots = 8;
  enum Stream : std::uint8_t { kColour = 0, kDepth = 1 };

  struct Image {
    std::span<std::uint8_t> bytes;
    std::int64_t stamp_us = 0;
  };
  struct Pair {
    Image colour;
    Image depth;
  };

  void reset(std::size_t colour_bytes, std::size_t depth_bytes, std::int64_t tolerance_us);

  // Forgets what is waiting (after a replug); what was lent stays valid until release().
  void clear();

  // The buffer that the next image of a stream goes into; commit() puts it in the queue. Where no buffer is
  // free, the oldest waiting image of that stream gives its own up and is counted as unmatched.
  std::span<std::uint8_t> next_buffer(Stream stream);
  void commit(Stream stream, std::int64_t stamp_us);

  // The next pair, lent until release(). False when there is none yet.
  bool take(Pair& pair);
  void release();

  std::uint64_t unmatched(Stream stream) const { return queues_[stream].unmatched; }
  std::size_t waiting(Stream stream) const { return queues_[stream].count; }
  // By how much the last image without a partner missed the nearest image of the other stream; 0: none did
  // yet.
  std::int64_t last_miss_us() const { return last_miss_us_; }

 private:
  // One more buffer than may wait: the one that is lent.
  static constexpr std::size_t kBuffers = kSlots + 1;
  static constexpr std::size_t kNone = kBuffers;
  struct Queue {
    std::vector<std::uint8_t> memory;
    std::size_t bytes = 0;
    std::array<std::size_t, kBuffers> order{};  // waiting buffers, oldest first
    std::size_t count = 0;
    std::array<bool, kBuffers> used{};
    std::array<std::int64_t, kBuffers> stamp_us{};
    std::size_t filling = kNone;
    std::size_t lent = kNone;
    std::uint64_t unmatched = 0;
  };
  static std::span<std::uint8_t> buffer(Queue& queue, std::size_t index);
  static std::size_t pop(Queue& queue);
  static void drop_oldest(Queue& queue);

  std::array<Queue, 2> queues_;
  std::int64_t tolerance_us_ = 0;
  std::int64_t last_miss_us_ = 0;
};

}  // namespace plvo
