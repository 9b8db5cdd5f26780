// SPDX-License-Identifier: Apache-2.0
// What plvo.Config is for Python: a preset is settings and the limits that they fit into.
#pragma once

#include "plvo/odometry/config.hpp"

namespace plvo::python {

enum class Preset { kDefault, kPaper, kTiny };

struct Settings {
  Preset preset = Preset::kDefault;
  Config config;
  Limits limits;  // but for the size of the image, which is the camera's
};

}  // namespace plvo::python
