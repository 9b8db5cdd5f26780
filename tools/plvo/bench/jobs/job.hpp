// SPDX-License-Identifier: Apache-2.0
// One measurement: one system over one sequence, once. It runs in a process of its own, so that its peak
// memory is its own, and leaves one JSON file; a job whose file is there is done.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/eval/trajectory.hpp"

namespace plvo::bench {

// How every job of one run is measured.
struct JobOptions {
  std::size_t frames = 0;    // 0: all
  std::string camera_model;  // empty: calibration.txt, or what the folder's name says
  eval::GroundTruthSampling sampling = eval::GroundTruthSampling::kInterpolated;
};

struct Job {
  std::filesystem::path folder;  // in TUM's layout
  std::string sequence;          // its name in the tables
  std::string system;
  int repeat = 0;
  JobOptions options;

  std::filesystem::path result_file(const std::filesystem::path& out) const;
  // What a result must say for this job to count as done.
  nlohmann::ordered_json key() const;
  // The command line of the worker, ready for exec.
  std::vector<std::string> command(const std::string& program, const std::filesystem::path& out) const;
};

// Repeats outermost and systems innermost: what the machine does in the meantime then meets all systems
// alike.
struct NamedFolder {
  std::filesystem::path folder;
  std::string sequence;
  std::string camera_model;  // empty: as the options say
};
std::vector<Job> interleaved_jobs(const std::vector<NamedFolder>& sequences,
                                  const std::vector<std::string>& systems, int repeats,
                                  const JobOptions& options);

// A command line for a shell: words that need it are quoted.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace plvo::bench
