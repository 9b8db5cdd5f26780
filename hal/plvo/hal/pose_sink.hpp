// SPDX-License-Identifier: Apache-2.0
// Where poses go: a file, a socket, a robot's message bus.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

class PoseSink {
 public:
  // Called once a frame, lost ones included, on the thread of the odometry: must not wait for whoever reads.
  // What is not ok ends the output (a full disk), not the odometry; a reader that merely cannot keep up is
  // not an error.
  virtual Status write(const TrackResult& result) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would ask every board for operator delete.
  ~PoseSink() = default;
};

}  // namespace plvo
