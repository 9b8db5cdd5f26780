// SPDX-License-Identifier: Apache-2.0
// What the virtual device does just now, changed by the commands that virtual_device.hpp lists.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "virtual_device.hpp"

namespace plvo_test {

inline constexpr std::int64_t kWrap_us = 71582788;  // of the Kinect's clock

struct Settings {
  bool plugged = true;
  bool colour_runs = true, depth_runs = true;
  std::int64_t period_us = 0;  // 0: the video mode's
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
  std::int64_t allowed = -1;  // ticks left until the next allow; -1: without end
};
extern std::mutex settings_mutex;
extern std::mutex source_mutex;  // held while the source runs: set_source() waits for it
extern Settings settings;        // under settings_mutex

// Every command but plug and unplug. False when it is not understood.
bool change_settings(const std::string& verb, const std::string& what);

}  // namespace plvo_test
