// SPDX-License-Identifier: Apache-2.0
// Reads the Kinect v1's accelerometer at 100 Hz on a separate thread. An error is logged once and does not
// stop the thread, which looks for the Kinect again every second.
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
  std::int64_t host_ns = 0;         // posix_monotonic_ns(), midpoint between request and answer
  Vector3 force = Vector3::Zero();  // as KinectState::acceleration
};

class KinectAccelerometer {
 public:
  static constexpr std::int64_t kPeriod_ns = 10'000'000;
  // Slower answers are discarded, because their sampling time is too uncertain.
  static constexpr std::int64_t kLongestAnswer_ns = 20'000'000;
  static constexpr std::size_t kMostWaiting = 1000;  // capacity for waiting readings; the oldest are dropped

  struct Counters {
    std::uint64_t readings = 0;
    std::uint64_t late = 0;      // answers slower than kLongestAnswer_ns
    std::uint64_t failures = 0;  // no answer or no Kinect
  };

  // consequence: text for the log that names the effect of a failure.
  KinectAccelerometer(Log& log, const char* consequence) : log_(log), consequence_(consequence) {}
  ~KinectAccelerometer() { stop(); }
  KinectAccelerometer(const KinectAccelerometer&) = delete;
  KinectAccelerometer& operator=(const KinectAccelerometer&) = delete;

  // camera_port: as for KinectMotor::open.
  void start(const std::string& camera_port);
  // Returns within one second, the longest duration of a request.
  void stop();

  // Appends the readings since the last call to `readings`, oldest first.
  void take(std::vector<KinectReading>& readings);
  Counters counters() const;

 private:
  void run(const std::string& camera_port);
  void keep(const KinectReading& reading);
  void fail(const Status& status);
  bool wait_until(std::int64_t host_ns);  // false: stop was requested

  Log& log_;
  const char* consequence_;
  std::thread thread_;
  mutable std::mutex mutex_;  // protects stop_, waiting_ and counters_
  std::condition_variable wake_;
  bool stop_ = false;
  std::vector<KinectReading> waiting_;
  Counters counters_;
  bool said_failure_ = false, said_return_ = false;  // used by the thread only
};

}  // namespace plvo
