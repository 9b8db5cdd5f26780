// SPDX-License-Identifier: Apache-2.0
// Sends MAVLink's ODOMETRY over UDP, one datagram for each frame with a pose.
#pragma once

#include <string>

#include "plvo/base/status.hpp"
#include "plvo/hal/pose_sink.hpp"
#include "plvo/host/stream/mavlink_odometry.hpp"

namespace plvo {

class MavlinkStream final : public PoseSink {
 public:
  MavlinkStream() = default;
  ~MavlinkStream();
  MavlinkStream(const MavlinkStream&) = delete;
  MavlinkStream& operator=(const MavlinkStream&) = delete;

  // address: "127.0.0.1:14550", "[::1]:14550", "autopilot:14550"; "14550" is on this machine.
  // kInvalidArgument for an address that does not exist, kIo.
  Status open(const std::string& address);
  // result: of the robot's base (result_of_base). Always ok: UDP does not tell whether anybody listens, and a
  // datagram that the network does not take is lost.
  Status write(const TrackResult& result) override;
  bool is_open() const { return socket_ >= 0; }

 private:
  MavlinkOdometry odometry_;
  int socket_ = -1;
};

}  // namespace plvo
