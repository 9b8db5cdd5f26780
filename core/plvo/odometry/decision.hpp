// SPDX-License-Identifier: Apache-2.0
// How a frame ends, and what follows from it.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/odometry/window/window.hpp"

namespace plvo {

struct Decision {
  enum class Outcome : std::uint8_t {
    kTrack,  // the motion was found
    kStart,  // the frame starts a trajectory: the first one, or another one after a loss
    kWait,   // there is no trajectory, and the frame cannot start one
    kLose,   // the motion was not found
  };
  enum class Gravity : std::uint8_t { kRead, kLevel, kTaken };  // how kStart takes in gravity
  Outcome outcome = Outcome::kTrack;
  Status status;
  Window::Kept kept;        // kTrack: the references that stay
  PoseWithCovariance pose;  // kStart
  Gravity gravity = Gravity::kRead;
  bool new_world = false;          // the position in the old world is not known any more
  bool usable = false;             // kLose: the next frame can be matched with this one
  bool depth_has_stopped = false;  // kLose: the depth image is an old one
};

}  // namespace plvo
