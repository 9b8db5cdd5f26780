// SPDX-License-Identifier: Apache-2.0
// Receives poses and writes them to a file, a socket or a robot's message bus.
#pragma once

#include "plvo/base/status.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

class PoseSink {
 public:
  // Called once per frame, including lost ones, on the thread of the odometry. It must not wait for a reader.
  // A status that is not ok (a full disk) ends the output, but not the odometry. A slow reader is not an
  // error.
  virtual Status write(const TrackResult& result) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would require operator delete on every board.
  ~PoseSink() = default;
};

}  // namespace plvo
