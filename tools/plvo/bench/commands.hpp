// SPDX-License-Identifier: Apache-2.0
// The subcommands of plvo_bench; main.cpp lists them.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"

namespace plvo::bench {

// What every command that measures understands.
struct CommonOptions {
  std::vector<std::string> systems = {"all"};
  std::filesystem::path out;
  int repeats = 1;
  int jobs = 1;
  bool list_jobs = false;
  JobOptions measuring;
};
void add_common_options(CLI::App& command, CommonOptions& options);
void add_measuring_options(CLI::App& command, JobOptions& options);
// An option that takes words with commas between them. The help names the default, which is what `words`
// holds.
void add_list(CLI::App& command, const std::string& name, std::vector<std::string>& words,
              const std::string& what);

// Makes out/jobs. kIo when it cannot.
Status make_out(const std::filesystem::path& out);
// One line on standard error when there is something to say; the exit code.
int finish(const Status& status);

// run DIR…, tum DIR…, worker …
void add_sequences(CLI::App& app, int& exit_code);
// lighting, sequence
void add_lighting(CLI::App& app, int& exit_code);
// stages [DIR]
void add_stages(CLI::App& app, int& exit_code);
// growth [DIR…]
void add_growth(CLI::App& app, int& exit_code);
// detectors [DIR…]
void add_detectors(CLI::App& app, int& exit_code);

}  // namespace plvo::bench
