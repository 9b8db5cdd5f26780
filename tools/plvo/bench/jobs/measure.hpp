// SPDX-License-Identifier: Apache-2.0
// Runs one job in this process: one thread, decoding and every conversion outside of the timed part, CPU time
// (of all threads, so that a hidden one would show).
#pragma once

#include <filesystem>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"

namespace plvo::bench {

// Writes the trajectory (every frame: a lost one stays where the last good one was) and then the result to
// out/jobs.
Status measure(const Job& job, const std::filesystem::path& out);

}  // namespace plvo::bench
