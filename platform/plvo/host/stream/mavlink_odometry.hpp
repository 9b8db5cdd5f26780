// SPDX-License-Identifier: Apache-2.0
// MAVLink's message ODOMETRY (id 331 of the dialect "common"), in frames of MAVLink 2, from the public
// description of the protocol (mavlink.io). MAVLink's frames have x forward, y right, z down; those of
// REP 105 have y left and z up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "plvo/host/motion_twist.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

// CRC-16/MCRF4XX, which MAVLink calls X.25; `crc`: of the bytes before.
std::uint16_t crc16_mcrf4xx(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0xffff);

class MavlinkOdometry {
 public:
  static constexpr std::uint8_t kSystem = 1;       // the vehicle's first system, that of its autopilot
  static constexpr std::uint8_t kComponent = 197;  // MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY

  // base: result_of_base of each frame, in order. Returns the message, or nothing for a frame without a pose.
  // The velocity is NaN, and so is the first element of its covariance, where it was not measured.
  std::optional<std::vector<std::uint8_t>> message(const TrackResult& base);

 private:
  MotionTwist twist_;
  std::uint8_t sequence_ = 0;
  std::uint8_t resets_ = 0;
  bool started_ = false;
  std::uint32_t world_ = 0;  // of the last pose
};

}  // namespace plvo
