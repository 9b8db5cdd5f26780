// SPDX-License-Identifier: Apache-2.0
// Runs one job in this process: one thread, decoding and every conversion outside of the timed part, CPU time
// (of all threads, so that a hidden one would show).
#pragma once

#include <filesystem>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/replay/calibration.hpp"

namespace plvo::bench {

// The folder's calibration.txt; without one the camera of that name; without a name the TUM camera that the
// folder's name speaks of (freiburg1, fr2_…). kNotFound when none of this helps.
Status find_calibration(const std::filesystem::path& folder, const std::string& camera_model,
                        Calibration& calibration);

// Writes the trajectory (every frame: a lost one stays where the last good one was) and then the result to
// out/jobs.
Status measure(const Job& job, const std::filesystem::path& out);

}  // namespace plvo::bench
