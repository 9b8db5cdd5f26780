// SPDX-License-Identifier: Apache-2.0
// Current state of the virtual device, changed by the commands that virtual_device.hpp lists.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "virtual_device.hpp"

namespace plvo_test {

inline constexpr std::int64_t kWrap_us = 71582788;  // range of the Kinect's clock

struct Settings {
  bool plugged = true;
  bool colour_runs = true, depth_runs = true;
  std::int64_t period_us = 0;  // 0: that of the video mode
  std::int64_t clock_us = 1000000;
  bool wraps = false;
  std::int64_t shift_us = kPatternDepthOffset_us;
  std::size_t late = 0;
  bool dark = false, zero_depth = false;
  int damage = 0;
  bool unplug_at_end = false, to_and_fro = false;
  bool registration = true, mirror_stuck = false, no_fov = false;
  VirtualSource source = nullptr;
  void* cookie = nullptr;
  std::int64_t ticks = 0;
  std::int64_t allowed = -1;  // ticks left until the next allow; -1: unlimited
};
extern std::mutex settings_mutex;
extern std::mutex source_mutex;  // held while the source runs, so that set_source() waits for it
extern Settings settings;        // protected by settings_mutex

// Applies every command except plug and unplug. Returns false if the command is not understood.
bool change_settings(const std::string& verb, const std::string& argument);

}  // namespace plvo_test
