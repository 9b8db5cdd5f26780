// SPDX-License-Identifier: Apache-2.0
// Any camera, read ahead: while a frame is computed on, a thread of its own reads, or decodes, or renders the
// next ones. What comes, and in which order, is what the camera gives; only when it is asked differs. For
// recordings and simulators: of a live sensor only the newest frame counts (FrameRing).
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/host/frame_copy.hpp"

namespace plvo {

class PrefetchedCamera final : public RgbdCamera {
 public:
  // Borrowed, and asked by the thread alone until this is gone: at once, since that thread starts here. Room
  // is made for frames of the camera's size.
  explicit PrefetchedCamera(RgbdCamera& camera);
  // Waits for the call of the camera's next() that is under way.
  ~PrefetchedCamera();
  PrefetchedCamera(const PrefetchedCamera&) = delete;
  PrefetchedCamera& operator=(const PrefetchedCamera&) = delete;

  // Returns when it is as far ahead as it goes: what reading takes, memory too, has been taken then.
  void wait_until_ahead();

  CameraModel model() const override { return model_; }
  // What the camera's next() came to. After the end of the stream, and after what it cannot go on from, it is
  // asked no more: that is the answer from then on.
  Status next(RgbdFrame& frame) override;

 private:
  struct Slot {
    Status status;
    FrameCopy copy;
  };
  void work();

  RgbdCamera& camera_;
  const CameraModel model_;
  std::array<Slot, 3> slots_;  // one that is read, one that waits, one that is written
  // Counted from the first call: the slots in [taken_, read_) wait. The one before them belongs to the
  // reader.
  std::size_t read_ = 0, taken_ = 0;
  bool ended_ = false;  // no further frame is requested
  bool last_read_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace plvo
