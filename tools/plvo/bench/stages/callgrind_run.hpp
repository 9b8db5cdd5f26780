// SPDX-License-Identifier: Apache-2.0
// `plvo_bench stages` under valgrind's callgrind: the same count in every run, however busy the machine is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/stages/callgrind_costs.hpp"
#include "plvo/bench/stages/stage_times.hpp"

namespace plvo::bench {

enum class ProfileOf : std::uint8_t { kAllFrames, kEachFrame };

// The command line that tracks the sequence under callgrind; the profile, or one for each frame with its
// number behind the name, is left at `profile`. kNotFound without valgrind.
Status callgrind_command(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                         const std::filesystem::path& profile, ProfileOf what,
                         std::vector<std::string>& command);

// What a run with kEachFrame has left. kDamaged where there is nothing.
Status read_frame_profiles(const std::filesystem::path& profile, std::vector<CallgrindCosts>& frames);

}  // namespace plvo::bench
