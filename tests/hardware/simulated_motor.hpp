// SPDX-License-Identifier: Apache-2.0
// The motor of a Kinect v1 (1414) on the hub of the simulated camera. The device reports the tilt and the
// accelerometer reading.
#pragma once

#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <string>

#include "simulated_kinect.hpp"

namespace plvo_test {

class SimulatedMotor {
 public:
  // Sets the accelerometer reading in counts (819 per g): x right, y up, z forward.
  using Reads = std::function<std::array<int, 3>()>;

  // The bus must outlive this object.
  SimulatedMotor(SimulatedKinect& kinect, Reads reads) : kinect_(kinect), reads_(std::move(reads)) {}
  ~SimulatedMotor();
  SimulatedMotor(const SimulatedMotor&) = delete;
  SimulatedMotor& operator=(const SimulatedMotor&) = delete;

  void plug();  // into port 1-1.1, once
  // After this call, every request fails with this bus error (errno); 0: requests return a reading again.
  void set_error(int error) { error_ = error; }
  int questions() const { return questions_; }

 private:
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user);
  int control(const std::uint8_t* setup, std::uint8_t* data, int length);

  SimulatedKinect& kinect_;
  Reads reads_;
  std::atomic<int> error_{0}, questions_{0};
  UMockdevIoctlBase* handler_ = nullptr;
  std::mutex mutex_;
  std::deque<usbdevfs_urb*> done_;
};

}  // namespace plvo_test
