// SPDX-License-Identifier: Apache-2.0
// One measurement: a single pass of one system over one sequence. It runs in its own process, so that the
// peak memory is its own, and writes one JSON file. A job whose file exists is done.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/eval/trajectory.hpp"

namespace plvo::bench {

// Options common to all jobs of a run.
struct JobOptions {
  std::size_t frames = 0;    // 0: all
  std::string camera_model;  // empty: calibration.txt, or the model that the folder's name implies
  eval::GroundTruthSampling sampling = eval::GroundTruthSampling::kInterpolated;
};

struct Job {
  std::filesystem::path folder;  // in TUM's layout
  std::string sequence;          // name of the sequence in the tables
  std::string system;
  int repeat = 0;
  JobOptions options;

  std::filesystem::path result_file(const std::filesystem::path& out) const;
  // Returns the entries that a result file must contain for this job to count as done.
  nlohmann::ordered_json key() const;
  // Returns the command line of the worker, ready for exec.
  std::vector<std::string> command(const std::string& program, const std::filesystem::path& out) const;
};

struct NamedFolder {
  std::filesystem::path folder;
  std::string sequence;
  std::string camera_model;  // empty: as in the options
};
// Returns the jobs with the repeats in the outermost loop and the systems in the innermost: a change of the
// machine's load then affects all systems alike.
std::vector<Job> interleaved_jobs(const std::vector<NamedFolder>& sequences,
                                  const std::vector<std::string>& systems, int repeats,
                                  const JobOptions& options);

// Returns a command line for a shell; quotes the words that need it.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace plvo::bench
