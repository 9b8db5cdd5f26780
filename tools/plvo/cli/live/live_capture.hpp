// SPDX-License-Identifier: Apache-2.0
// The thread that reads a live camera: frames go into the ring and to the recording, troubles become a state
// in words. It ends when it is told to, when the recording is over, or when the camera cannot go on, and
// closes the camera then: a thread that read from OpenNI2 may not end before OpenNI2 does.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/live/live_camera.hpp"
#include "plvo/cli/live/rate_meter.hpp"
#include "plvo/cli/record/frame_recording.hpp"
#include "plvo/host/frame_ring.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/replay/checks/frame_check.hpp"
#include "plvo/replay/paced_camera.hpp"

namespace plvo::cli {

class LiveCapture {
 public:
  struct State {
    std::string words = "waiting for the first frame";
    Status last;      // of the last call of next(): ok while frames come
    Status end;       // why the camera cannot go on; ok otherwise
    Status recorder;  // why the recording ended by itself; ok otherwise
    std::uint64_t frames = 0, damaged = 0, timeouts = 0;
    double hz = 0;                    // over the last second
    double average_hz = 0;            // from the first frame to the last
    double seconds_since_frame = -1;  // negative: none has come yet
    OpenNi2Counters camera;

    // One word for programs: "waiting" for the first frame, "running", "stalled", "unplugged" or "damaged".
    const char* word() const;
  };

  // All are borrowed. pace: kRealtime delivers a frame no earlier than its stamp says.
  LiveCapture(LiveCamera& camera, Pace pace, FrameRing& ring, FrameRecording& recording, Console& console)
      : camera_(camera),
        paced_(camera, pace, clock_, nullptr),
        ring_(ring),
        recording_(recording),
        console_(console) {}
  ~LiveCapture() { stop(); }
  LiveCapture(const LiveCapture&) = delete;
  LiveCapture& operator=(const LiveCapture&) = delete;

  void start();
  // Returns within the camera's time limit, also where it waits for the stamp of a frame.
  void stop();
  State state() const;

 private:
  // Looks every tenth of a second whether the capture is to stop: a recording may have a gap of minutes.
  class StoppableClock final : public Clock {
   public:
    explicit StoppableClock(const std::atomic<bool>& stop) : stop_(stop) {}
    std::int64_t monotonic_ns() const override { return clock_.monotonic_ns(); }
    void sleep_until_ns(std::int64_t until_ns) override;

   private:
    const std::atomic<bool>& stop_;
    PosixClock clock_;
  };

  void run();
  void on_frame(const RgbdFrame& frame);
  void on_trouble(const Status& status);
  void poll_recording();
  void tell(const std::vector<std::string>& findings);

  std::atomic<bool> stop_{false};
  LiveCamera& camera_;
  StoppableClock clock_{stop_};
  PacedCamera paced_;
  FrameRing& ring_;
  FrameRecording& recording_;
  Console& console_;
  FrameCheck check_;  // of the thread
  std::thread thread_;

  mutable std::mutex mutex_;  // state_, meter_ and the three times
  State state_;
  RateMeter meter_;
  std::int64_t first_ns_ = 0, last_ns_ = 0;  // arrivals
  std::int64_t trouble_since_ns_ = 0;        // 0: none
};

}  // namespace plvo::cli
