// SPDX-License-Identifier: Apache-2.0
// What the C functions of the odometry and of the map share.
#pragma once

#include <cstdint>

#include "plvo/c/plvo.h"
#include "plvo/odometry/odometry.hpp"

struct plvo_odometry {
  plvo::Odometry odometry;
  // The caller's functions, which the core's own call.
  void (*stage_hook)(void* context, std::int32_t stage) = nullptr;
  void* stage_hook_context = nullptr;
  void (*executor)(void* runner, plvo_task here, plvo_task beside) = nullptr;
  void* runner = nullptr;
};

namespace plvo::c {

inline constexpr const char* kNoOdometry = "odometry is NULL: plvo_init comes first";

// All of a config but its functions. NULL: the default stays.
Status take_config(const plvo_config* given, Config& config);

}  // namespace plvo::c
