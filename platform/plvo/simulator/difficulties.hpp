// SPDX-License-Identifier: Apache-2.0
// What makes a simulated sequence hard: things that move, a mirror, things that the camera carries along, and
// faults of the sensor. They may be combined. By default there are none. The camera's trajectory and the
// ground truth do not change.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo {

// A textured board, square to the camera's first view of it. Its velocity is constant: the mean velocity of
// the camera from from_s to to_s, plus speed_mps to the right. It does not exist at other times.
struct MovingBoard {
  double from_s = 0.65, to_s = 2.65;  // since the first frame
  double distance_m = 1;              // from the camera, at from_s
  double share = 0.3;                 // of the image's width, at from_s
  double first_column = 0;  // left edge at from_s as a share of the image's width; negative: outside
  double speed_mps = 0.4;
};

// A person whose arms and legs swing and whose chest turns: ten solids, no two of which have the same motion.
struct WalkingPerson {
  double from_s = 0.65, to_s = 3.35;  // since the first frame
  double distance_m = 2;              // from the camera, at from_s
  bool ahead = false;                 // goes ahead at the camera's mean velocity instead of crossing the view
  double speed_mps = 1.2;             // when crossing, from the left to the right
};

struct Difficulties {
  std::optional<MovingBoard> board;
  std::optional<WalkingPerson> person;
  // A mirror of 0.8 × 1.6 m, upright, 2 m ahead of the first pose in the left half of the view. Its depth is
  // that of its plane.
  bool mirror = false;
  double bumper_share = 0;          // lowest share of the image that shows the robot's own bumper
  double dots_share = 0;            // dots of an infrared projector per pixel, at fixed pixels
  bool clock = false;               // digits of a clock in the upper left corner
  bool comb = false;                // depth of rows and columns 0, 2, 4 … is empty
  std::optional<int> frozen_depth;  // from this frame on, depth is that of this frame
  bool repeated_frames = false;     // each odd frame has the images of the frame before it

  // Returns kInvalidArgument with the name of the option for a value out of range.
  Status validate() const;
};

// Adds one difficulty by name, with default values. Returns kInvalidArgument with all names for any other
// text.
Status add_difficulty(std::string_view name, Difficulties& difficulties);
// "board", "person", "person-ahead", "mirror", "bumper", "dots", "clock", "comb", "frozen-depth",
// "repeated-frames".
std::vector<std::string> difficulty_names();

}  // namespace plvo
