// SPDX-License-Identifier: Apache-2.0
// Used if OpenCV's contrib modules are not installed.
#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {

std::unique_ptr<System> make_opencv_system(const std::string& /*name*/, const CameraModel& /*camera*/) {
  return nullptr;
}

std::string opencv_version() { return {}; }

}  // namespace plvo::bench
