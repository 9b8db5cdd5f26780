// SPDX-License-Identifier: Apache-2.0
// Sequences of the simulated camera as folders in TUM's layout.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

// Does nothing if `folder` exists. Otherwise renders into a folder beside it and renames that when it is
// complete.
Status render_sequence(const SimulatorOptions& options, const std::filesystem::path& folder);

}  // namespace plvo::bench
