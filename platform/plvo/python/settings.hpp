// SPDX-License-Identifier: Apache-2.0
// What plvo.Config is for Python: a preset is settings and the limits that they have the room for.
#pragma once

#include "plvo/odometry/config.hpp"

namespace plvo::python {

struct Settings {
  Config config;
  Limits limits;  // but for the size of the image, which is the camera's
};

}  // namespace plvo::python
