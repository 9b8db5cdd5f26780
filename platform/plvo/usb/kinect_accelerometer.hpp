// SPDX-License-Identifier: Apache-2.0
// The Kinect v1's accelerometer, asked a hundred times a second by a thread of its own beside the camera's.
// What goes wrong is said once, and stops nobody: the thread looks for the Kinect again every second.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "plvo/hal/log.hpp"
#include "plvo/usb/kinect_motor.hpp"

namespace plvo {

struct KinectReading {
  std::int64_t host_ns = 0;         // posix_monotonic_ns(), half-way between question and answer
  Vector3 force = Vector3::Zero();  // as KinectState::acceleration
};

class KinectAccelerometer {
 public:
  static constexpr std::int64_t kPeriod_ns = 10'000'000;
  // Of an answer that takes longer nobody knows when it was true.
  static constexpr std::int64_t kLongestAnswer_ns = 20'000'000;
  static constexpr std::size_t kMostWaiting = 1000;  // readings that nobody takes; the oldest go

  struct Counters {
    std::uint64_t readings = 0;
    std::uint64_t late = 0;      // answers that took too long
    std::uint64_t failures = 0;  // no answer, or no Kinect
  };

  // consequence: of a failure, for whoever reads the log.
  KinectAccelerometer(Log& log, const char* consequence) : log_(log), consequence_(consequence) {}
  ~KinectAccelerometer() { stop(); }
  KinectAccelerometer(const KinectAccelerometer&) = delete;
  KinectAccelerometer& operator=(const KinectAccelerometer&) = delete;

  // camera_port: as of KinectMotor::open.
  void start(const std::string& camera_port);
  // Returns within the second that a question may take.
  void stop();

  // What came since the last call, oldest first, behind what is there already.
  void take(std::vector<KinectReading>& readings);
  Counters counters() const;

 private:
  void run(const std::string& camera_port);
  void keep(const KinectReading& reading);
  void fail(const Status& status);
  bool wait_until(std::int64_t host_ns);  // false: stop

  Log& log_;
  const char* consequence_;
  std::thread thread_;
  mutable std::mutex mutex_;  // stop_, waiting_ and counters_
  std::condition_variable wake_;
  bool stop_ = false;
  std::vector<KinectReading> waiting_;
  Counters counters_;
  bool said_failure_ = false, said_return_ = false;  // the thread's own
};

}  // namespace plvo
