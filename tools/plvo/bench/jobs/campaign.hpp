// SPDX-License-Identifier: Apache-2.0
// Many jobs and what came of them. Work that is done is not done again: the folder of results is the memory.
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

// For a shell, one a line on standard output. kInvalidArgument for a word that no line can hold as it is.
Status print_jobs(const std::vector<std::vector<std::string>>& commands);

// Says on standard error what has ended. kDamaged, with how many, when some failed.
Status run_and_report(const std::vector<std::vector<std::string>>& commands,
                      const std::vector<std::string>& names, int at_a_time);

// Of the jobs that are done, in their order.
std::vector<Result> read_results(const std::vector<Job>& jobs, const std::filesystem::path& out);

// One for each sequence and system, in order of appearance: times are medians over the repeats, memory is the
// largest, all else is the same in every repeat of a deterministic system and taken from the first.
std::vector<Result> merge_repeats(const std::vector<Result>& results);

// CPU time of `system` over that of `peer` on the same sequence: median over the repeats of the ratio within
// a repeat. NaN where there is no such pair.
double relative_cpu(const std::vector<Result>& results, const std::string& sequence,
                    const std::string& system, const std::string& peer);

double median(std::vector<double> values);  // NaN for none

// out/<name>.md, .csv, .json (every result as measured, and the host), .html.
struct Report {
  std::string name, title;
  Table table;              // rounded, for readers
  Table exact;              // for the CSV
  std::vector<Table> more;  // below it in the Markdown
  std::vector<std::string> notes;
};
Status write_report(const Report& report, const std::vector<Result>& results, const Host& host,
                    const std::filesystem::path& out);

}  // namespace plvo::bench
