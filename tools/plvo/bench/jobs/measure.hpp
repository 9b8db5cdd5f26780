// SPDX-License-Identifier: Apache-2.0
// Runs one job in this process, on one thread. Decoding and every conversion are outside of the timed part.
// The CPU time is that of all threads, so that a hidden thread would show.
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"

namespace plvo::bench {

// Writes the trajectory and then the result to out/jobs. The trajectory has every frame; a lost frame gets
// the last good pose.
Status measure(const Job& job, const std::filesystem::path& out);

}  // namespace plvo::bench
