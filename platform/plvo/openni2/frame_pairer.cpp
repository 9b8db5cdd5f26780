// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/frame_pairer.hpp"

#include <cassert>
#include <cstdlib>

namespace plvo {

void FramePairer::reset(std::size_t colour_bytes, std::size_t depth_bytes, std::int64_t tolerance_us) {
  const std::array<std::size_t, 2> bytes = {colour_bytes, depth_bytes};
  for (std::size_t s = 0; s < 2; ++s) {
    queues_[s] = Queue{};
    queues_[s].bytes = bytes[s];
    queues_[s].memory.resize(bytes[s] * kBuffers);
  }
  tolerance_us_ = tolerance_us;
  last_miss_us_ = 0;
}

void FramePairer::clear() {
  for (Queue& queue : queues_) {
    while (queue.count > 0) drop_oldest(queue);
    if (queue.filling != kNone) queue.used[queue.filling] = false;
    queue.filling = kNone;
  }
}

std::span<std::uint8_t> FramePairer::buffer(Queue& queue, std::size_t index) {
  return std::span<std::uint8_t>(queue.memory).subspan(index * queue.bytes, queue.bytes);
}

std::size_t FramePairer::pop(Queue& queue) {
  const std::size_t index = queue.order[0];
  for (std::size_t i = 1; i < queue.count; ++i) queue.order[i - 1] = queue.order[i];
  --queue.count;
  return index;
}

void FramePairer::drop_oldest(Queue& queue) {
  queue.used[pop(queue)] = false;
  ++queue.unmatched;
}

std::span<std::uint8_t> FramePairer::next_buffer(Stream stream) {
  Queue& queue = queues_[stream];
  if (queue.filling == kNone) {
    if (queue.count == kSlots) drop_oldest(queue);
    std::size_t index = 0;
    while (queue.used[index])
      ++index;  // at most kSlots buffers wait and one is lent, so one of kBuffers is free
    queue.used[index] = true;
    queue.filling = index;
  }
  return buffer(queue, queue.filling);
}

void FramePairer::commit(Stream stream, std::int64_t stamp_us) {
  Queue& queue = queues_[stream];
  assert(queue.filling != kNone);
  queue.stamp_us[queue.filling] = stamp_us;
  queue.order[queue.count++] = queue.filling;
  queue.filling = kNone;
}

bool FramePairer::take(Pair& pair) {
  Queue& colour = queues_[kColour];
  Queue& depth = queues_[kDepth];
  while (colour.count > 0 && depth.count > 0) {
    const std::int64_t ahead_us = colour.stamp_us[colour.order[0]] - depth.stamp_us[depth.order[0]];
    if (std::abs(ahead_us) > tolerance_us_) {
      last_miss_us_ = std::abs(ahead_us);
      drop_oldest(ahead_us > 0 ? depth : colour);
      continue;
    }
    release();
    colour.lent = pop(colour);
    depth.lent = pop(depth);
    pair.colour = {buffer(colour, colour.lent), colour.stamp_us[colour.lent]};
    pair.depth = {buffer(depth, depth.lent), depth.stamp_us[depth.lent]};
    return true;
  }
  return false;
}

void FramePairer::release() {
  for (Queue& queue : queues_) {
    if (queue.lent != kNone) queue.used[queue.lent] = false;
    queue.lent = kNone;
  }
}

}  // namespace plvo
