// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/prefetched_camera.hpp"

namespace plvo {

PrefetchedCamera::PrefetchedCamera(RgbdCamera& camera) : camera_(camera), model_(camera.model()) {
  for (Slot& slot : slots_)
    slot.copy.reserve(static_cast<std::size_t>(model_.width) * static_cast<std::size_t>(model_.height));
  thread_ = std::thread([this] { work(); });
}

PrefetchedCamera::~PrefetchedCamera() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PrefetchedCamera::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    // One slot stays with the reader.
    changed_.wait(lock, [this] { return ended_ || read_ - taken_ < slots_.size() - 1; });
    if (ended_) return;
    Slot& slot = slots_[read_ % slots_.size()];
    lock.unlock();
    RgbdFrame frame;
    slot.status = camera_.next(frame);
    // What is no frame has stamps at most.
    if (!slot.status.ok()) frame = {frame.stamp_ns, frame.depth_stamp_ns, {}, {}};
    slot.copy.assign(frame);
    const bool last = !goes_on_after(slot.status.code());
    lock.lock();
    ++read_;
    last_read_ = last;
    changed_.notify_all();
    if (last) return;
  }
}

void PrefetchedCamera::wait_until_ahead() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return last_read_ || read_ - taken_ == slots_.size() - 1; });
}

Status PrefetchedCamera::next(RgbdFrame& frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return taken_ < read_; });
  const Slot& slot = slots_[taken_ % slots_.size()];
  // The last answer stays.
  if (goes_on_after(slot.status.code())) ++taken_;
  lock.unlock();
  changed_.notify_all();
  frame = slot.copy.frame();
  return slot.status;
}

}  // namespace plvo
