// SPDX-License-Identifier: Apache-2.0
#include "virtual_settings.hpp"

#include <algorithm>
#include <cstdlib>

namespace plvo_test {

std::mutex settings_mutex;
std::mutex source_mutex;
Settings settings;

bool change_settings(const std::string& verb, const std::string& argument) {
  const std::int64_t n = std::atoll(argument.c_str());
  const std::lock_guard lock(settings_mutex);
  Settings& s = settings;
  if (verb == "reset")
    s = Settings{.plugged = s.plugged, .source = s.source, .cookie = s.cookie};
  else if (verb == "run")
    s.colour_runs = s.depth_runs = true;
  else if (verb == "stall")
    s.colour_runs = s.depth_runs = false;
  else if (verb == "stop" && argument == "colour")
    s.colour_runs = false;
  else if (verb == "stop" && argument == "depth")
    s.depth_runs = false;
  else if (verb == "period")
    s.period_us = n;
  else if (verb == "allow")
    s.allowed = std::max<std::int64_t>(s.allowed, 0) + n;
  else if (verb == "clock")
    s.clock_us = n;
  else if (verb == "wrap")
    s.wraps = true, s.clock_us = kWrap_us - n;
  else if (verb == "late")
    s.late = static_cast<std::size_t>(n);
  else if (verb == "shift")
    s.shift_us = n;
  else if (verb == "dark")
    s.dark = n != 0;
  else if (verb == "zero_depth")
    s.zero_depth = n != 0;
  else if (verb == "damage")
    s.damage = static_cast<int>(n);
  else if (verb == "after_end")
    s.unplug_at_end = argument == "unplug";
  else if (verb == "to_and_fro")
    s.to_and_fro = n != 0;
  else if (verb == "registration")
    s.registration = n != 0;
  else if (verb == "mirror_stuck")
    s.mirror_stuck = n != 0;
  else if (verb == "no_fov")
    s.no_fov = n != 0;
  else
    return false;
  return true;
}

}  // namespace plvo_test
