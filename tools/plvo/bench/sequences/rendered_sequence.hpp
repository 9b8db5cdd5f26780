// SPDX-License-Identifier: Apache-2.0
// Walks of the simulated camera as folders in TUM's layout.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

// Nothing to do where `folder` is there already; else renders beside it and moves it there when it is whole.
Status render_sequence(const SimulatorOptions& options, const std::filesystem::path& folder);

}  // namespace plvo::bench
