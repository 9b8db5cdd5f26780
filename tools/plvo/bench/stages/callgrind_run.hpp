// SPDX-License-Identifier: Apache-2.0
// Runs `plvo_bench stages` under valgrind's callgrind, whose count does not depend on the load of the
// machine.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/stages/callgrind_costs.hpp"
#include "plvo/bench/stages/stage_times.hpp"

namespace plvo::bench {

enum class ProfileOf : std::uint8_t { kAllFrames, kEachFrame };

// Builds the command line that tracks the sequence under callgrind. The run writes the profile to `profile`,
// or one profile for each frame with the frame's number appended. Returns kNotFound without valgrind.
Status callgrind_command(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                         const std::filesystem::path& profile, ProfileOf what,
                         std::vector<std::string>& command);

// Reads the profiles of a run with kEachFrame. Returns kDamaged if there are none.
Status read_frame_profiles(const std::filesystem::path& profile, std::vector<CallgrindCosts>& frames);

}  // namespace plvo::bench
