// SPDX-License-Identifier: Apache-2.0
#include "plvo/usb/kinect_accelerometer.hpp"

#include <algorithm>
#include <chrono>

#include "plvo/host/posix_clock.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kLookAgain_ns = 1'000'000'000;

}  // namespace

void KinectAccelerometer::start(const std::string& camera_port) {
  stop();
  stop_ = false;
  thread_ = std::thread([this, camera_port] { run(camera_port); });
}

void KinectAccelerometer::stop() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void KinectAccelerometer::take(std::vector<KinectReading>& readings) {
  const std::lock_guard lock(mutex_);
  readings.insert(readings.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
}

KinectAccelerometer::Counters KinectAccelerometer::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void KinectAccelerometer::run(const std::string& camera_port) {
  UsbBus bus;
  KinectMotor motor;
  bool open = false;
  std::int64_t next_ns = posix_monotonic_ns();
  do {
    Status status;
    if (!open) {
      status = bus.open();
      if (status.ok()) status = motor.open(bus, camera_port);
      open = status.ok();
    }
    const std::int64_t asked_ns = posix_monotonic_ns();
    KinectState state;
    if (status.ok()) status = motor.read(state);
    const std::int64_t answered_ns = posix_monotonic_ns();
    if (!status.ok()) {
      motor.close();
      open = false;
      fail(status);
      next_ns = answered_ns + kLookAgain_ns;
    } else if (answered_ns - asked_ns > kLongestAnswer_ns) {
      const std::lock_guard lock(mutex_);
      ++counters_.late;
    } else {
      keep({asked_ns + (answered_ns - asked_ns) / 2, state.acceleration});
    }
    // After a delay the period restarts from now.
    next_ns = std::max(next_ns + kPeriod_ns, answered_ns);
  } while (wait_until(next_ns));
}

void KinectAccelerometer::keep(const KinectReading& reading) {
  {
    const std::lock_guard lock(mutex_);
    ++counters_.readings;
    if (waiting_.size() >= kMostWaiting) waiting_.erase(waiting_.begin());
    waiting_.push_back(reading);
  }
  if (!said_failure_ || said_return_) return;
  said_return_ = true;
  log_.write(LogLevel::kInfo, "the Kinect's accelerometer answers again");
}

void KinectAccelerometer::fail(const Status& status) {
  {
    const std::lock_guard lock(mutex_);
    ++counters_.failures;
  }
  if (said_failure_) return;
  said_failure_ = true;
  const Status words =
      Status(status.code(), "no accelerometer, ").append(consequence_).append(": ").append(status.message());
  log_.write(LogLevel::kWarning, words.message());
}

bool KinectAccelerometer::wait_until(std::int64_t host_ns) {
  std::unique_lock lock(mutex_);
  const std::int64_t left_ns = std::max<std::int64_t>(host_ns - posix_monotonic_ns(), 0);
  wake_.wait_for(lock, std::chrono::nanoseconds(left_ns), [this] { return stop_; });
  return !stop_;
}

}  // namespace plvo
