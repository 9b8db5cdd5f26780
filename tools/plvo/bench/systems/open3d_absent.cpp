// SPDX-License-Identifier: Apache-2.0
// Used if Open3D is not installed.
#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {

std::unique_ptr<System> make_open3d_system(const CameraModel& /*camera*/) { return nullptr; }

std::string open3d_version() { return {}; }

}  // namespace plvo::bench
