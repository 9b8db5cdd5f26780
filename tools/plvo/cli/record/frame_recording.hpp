// SPDX-License-Identifier: Apache-2.0
// What comes from a live camera, kept: as a TUM folder, encoded and written by a thread of its own from a
// ring of fixed size, or as an .oni file, which OpenNI2 writes. What is on the disk is valid at every moment.
#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "plvo/cli/live/live_camera.hpp"
#include "plvo/host/frame_ring.hpp"
#include "plvo/replay/tum_writer.hpp"

namespace plvo::cli {

class FrameRecording {
 public:
  // Frames that wait for the disk, at most: 1.6 s at 30 Hz, 74 MB in VGA.
  static constexpr std::size_t kSlots = 48;

  FrameRecording() = default;
  ~FrameRecording();
  FrameRecording(const FrameRecording&) = delete;
  FrameRecording& operator=(const FrameRecording&) = delete;

  // What open() would refuse of the path, before there is a camera; nothing is left there. path: FILE.oni or
  // a folder, neither of which may hold a recording already (kInvalidArgument says so), and that can be made.
  static Status check(const std::string& path);

  // every_frame: push() waits for room instead of dropping the oldest frame (for cameras that can wait).
  // max_frames: a folder takes no more than these.
  Status open(const std::string& path, LiveCamera& camera, bool every_frame,
              std::uint64_t max_frames = std::numeric_limits<std::uint64_t>::max());

  // Both on the thread that calls the camera's next(), after each call: push() for a frame, poll() always.
  // poll() is not ok, once, when the recording has ended by itself; the session may go on without it.
  void push(const RgbdFrame& frame);
  Status poll();

  // Waits until what is queued is on the disk. Not ok if that failed and poll() has not said so yet.
  Status stop();

  bool wanted() const { return camera_ != nullptr; }
  const std::string& path() const { return path_; }
  std::uint64_t frames() const { return frames_; }  // on the disk (.oni: offered)
  std::uint64_t dropped() const;                    // the disk was too slow

 private:
  void write_frames();
  Status take_failure();

  std::string path_;
  LiveCamera* camera_ = nullptr;  // null: nothing to record
  CameraModel model_;
  bool oni_ = false;
  std::uint64_t max_frames_ = 0, offered_ = 0;
  std::atomic<bool> ended_{false};
  std::atomic<std::uint64_t> frames_{0};
  std::unique_ptr<FrameRing> ring_;
  std::thread thread_;
  std::mutex mutex_;
  Status failure_;  // under mutex_
};

}  // namespace plvo::cli
