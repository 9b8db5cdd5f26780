// SPDX-License-Identifier: Apache-2.0
// Pairs colour and depth images by their stamps. Each stream writes into its own fixed buffers. The oldest
// colour image and the oldest depth image whose stamps differ by no more than the tolerance form a pair. The
// caller must set a tolerance of at most half a frame; then no later image can fit better, and no pair has to
// wait for one. An image that can no longer be paired is counted and its buffer is reused. Memory is
// allocated only in reset().
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace plvo {

class FramePairer {
 public:
  // One stream may lag behind the other by kSlots - 1 frames (230 ms at 30 Hz).
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

  // Discards the waiting images (after a replug); a lent pair stays valid until release().
  void clear();

  // Returns the buffer for the next image of a stream; commit() puts it into the queue. If no buffer is free,
  // the oldest waiting image of that stream is discarded and counted as unmatched.
  std::span<std::uint8_t> next_buffer(Stream stream);
  void commit(Stream stream, std::int64_t stamp_us);

  // Takes the next pair, lent until release(). Returns false if there is none yet.
  bool take(Pair& pair);
  void release();

  std::uint64_t unmatched(Stream stream) const { return queues_[stream].unmatched; }
  std::size_t waiting(Stream stream) const { return queues_[stream].count; }
  // Time between the last unmatched image and the nearest image of the other stream; 0 if every image was
  // matched.
  std::int64_t last_miss_us() const { return last_miss_us_; }

 private:
  // One buffer more than the waiting ones: the lent buffer.
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
