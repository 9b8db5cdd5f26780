// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/frame_ring.hpp"

#include <algorithm>
#include <chrono>

namespace plvo {

FrameRing::FrameRing(int width, int height, std::size_t slots, RingPolicy policy)
    : pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      policy_(policy),
      slots_(std::max<std::size_t>(slots, 3)),
      ready_(slots_.size()),
      reading_(slots_.size()) {
  free_.reserve(slots_.size());
  for (std::size_t i = slots_.size(); i-- > 0;) {
    slots_[i].copy.reserve(pixels_);
    free_.push_back(i);
  }
}

std::size_t FrameRing::pop_ready() {
  const std::size_t slot = ready_[first_];
  first_ = (first_ + 1) % ready_.size();
  --ready_count_;
  return slot;
}

bool FrameRing::push(const RgbdFrame& frame, std::int64_t arrival_ns) {
  const auto count = [](int width, int height) {
    return static_cast<std::size_t>(std::max(width, 0)) * static_cast<std::size_t>(std::max(height, 0));
  };
  std::unique_lock lock(mutex_);
  if (count(frame.colour.width, frame.colour.height) > pixels_ ||
      count(frame.depth.width, frame.depth.height) > pixels_) {
    ++counters_.refused;
    return false;
  }
  if (free_.empty() && policy_ == RingPolicy::kEvery) {
    slot_free_.wait(lock, [this] { return closed_ || !free_.empty(); });
  }
  if (closed_) return false;
  if (free_.empty()) {
    // At least one is ready: of three or more slots the reader holds one, and nobody else writes.
    free_.push_back(pop_ready());
    ++counters_.dropped;
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  lock.unlock();
  slots_[slot].copy.assign(frame);
  slots_[slot].arrival_ns = arrival_ns;
  lock.lock();
  ready_[(first_ + ready_count_) % ready_.size()] = slot;
  ++ready_count_;
  ++counters_.pushed;
  lock.unlock();
  frame_ready_.notify_one();
  return true;
}

void FrameRing::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  frame_ready_.notify_all();
  slot_free_.notify_all();
}

FrameRing::Take FrameRing::take(RgbdFrame& frame, std::int64_t& arrival_ns, int timeout_ms) {
  std::unique_lock lock(mutex_);
  if (reading_ < slots_.size()) {
    free_.push_back(reading_);
    reading_ = slots_.size();
    slot_free_.notify_one();
  }
  frame_ready_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                        [this] { return closed_ || ready_count_ > 0; });
  if (ready_count_ == 0) return closed_ ? Take::kClosed : Take::kTimeout;
  while (policy_ == RingPolicy::kNewest && ready_count_ > 1) {
    free_.push_back(pop_ready());
    ++counters_.dropped;
  }
  reading_ = pop_ready();
  ++counters_.taken;
  frame = slots_[reading_].copy.frame();
  arrival_ns = slots_[reading_].arrival_ns;
  return Take::kFrame;
}

FrameRing::Counters FrameRing::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace plvo
