// SPDX-License-Identifier: Apache-2.0
// Runs many jobs and reports their results. A finished job is not repeated: its result file marks it as done.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/host.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/table.hpp"

namespace plvo::bench {

std::vector<Job> missing_jobs(const std::vector<Job>& jobs, const std::filesystem::path& out);

// Prints the commands for a shell, one per line. Returns kInvalidArgument for a word that a line cannot hold
// verbatim.
Status print_jobs(const std::vector<std::vector<std::string>>& commands);

// Reports each finished job on standard error. Returns kDamaged, with the number of failures, if jobs failed.
Status run_and_report(const std::vector<std::vector<std::string>>& commands,
                      const std::vector<std::string>& names, int at_a_time);

// Returns the results of the finished jobs, in the order of the jobs.
std::vector<Result> read_results(const std::vector<Job>& jobs, const std::filesystem::path& out);

// Returns one result for each sequence and system, in order of appearance. Times are medians over the repeats
// and memory is the maximum. All other values are equal in every repeat of a deterministic system and come
// from the first.
std::vector<Result> merge_repeats(const std::vector<Result>& results);

// Returns the ratio of the CPU times of `system` and `peer` on the same sequence: the median over the repeats
// of the ratio within a repeat. NaN if there is no such pair.
double relative_cpu(const std::vector<Result>& results, const std::string& sequence,
                    const std::string& system, const std::string& peer);

double median(std::vector<double> values);  // NaN if empty

// The files out/<name>.md, .csv, .json (every result as measured, and the host) and .html.
struct Report {
  std::string name, title;
  Table table;              // rounded, for readers
  Table exact;              // unrounded, for the CSV
  std::vector<Table> more;  // below the first table in the Markdown
  std::vector<std::string> notes;
};
Status write_report(const Report& report, const std::vector<Result>& results, const Host& host,
                    const std::filesystem::path& out);

}  // namespace plvo::bench
