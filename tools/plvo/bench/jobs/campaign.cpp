// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/campaign.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {

std::vector<Job> missing_jobs(const std::vector<Job>& jobs, const std::filesystem::path& out) {
  std::vector<Job> missing;
  for (const Job& job : jobs) {
    Result result;
    if (!read_result(job.result_file(out), job, result).ok()) missing.push_back(job);
  }
  return missing;
}

Status print_jobs(const std::vector<std::vector<std::string>>& commands) {
  std::string lines;
  for (const std::vector<std::string>& command : commands) {
    for (const std::string& word : command)
      if (printable(word) != word)
        return {StatusCode::kInvalidArgument,
                fmt::format("'{}' has characters that a list of jobs cannot hold; rename it", word)};
    lines += shell_line(command) + '\n';
  }
  return print(lines);
}

Status run_and_report(const std::vector<std::vector<std::string>>& commands,
                      const std::vector<std::string>& names, int at_a_time) {
  const std::size_t failed =
      run_commands(commands, at_a_time, [&](std::size_t index, bool success, std::size_t ended) {
        print_to_stderr(
            fmt::format("[{}/{}] {}{}\n", ended, commands.size(), names[index], success ? "" : ": FAILED"));
      });
  if (failed == 0) return {};
  return {StatusCode::kDamaged,
          fmt::format("{} of {} jobs failed (see above); run the same command again for those alone", failed,
                      commands.size())};
}

std::vector<Result> read_results(const std::vector<Job>& jobs, const std::filesystem::path& out) {
  std::vector<Result> results;
  for (const Job& job : jobs) {
    Result result;
    if (read_result(job.result_file(out), job, result).ok()) results.push_back(result);
  }
  return results;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return eval::quantile(values, 0.5);
}

std::vector<Result> merge_repeats(const std::vector<Result>& results) {
  std::vector<Result> merged;
  for (const Result& result : results) {
    const auto same = [&result](const Result& other) {
      return other.sequence == result.sequence && other.system == result.system;
    };
    if (std::any_of(merged.begin(), merged.end(), same)) continue;
    std::vector<double> medians, p95s;
    Result all = result;
    for (const Result& other : results) {
      if (!same(other)) continue;
      medians.push_back(other.cpu_median_ms);
      p95s.push_back(other.cpu_p95_ms);
      all.peak_mb = std::max(all.peak_mb, other.peak_mb);
      all.growth_mb = std::max(all.growth_mb, other.growth_mb);
    }
    all.cpu_median_ms = median(medians);
    all.cpu_p95_ms = median(p95s);
    merged.push_back(all);
  }
  return merged;
}

double relative_cpu(const std::vector<Result>& results, const std::string& sequence,
                    const std::string& system, const std::string& peer) {
  std::vector<double> ratios;
  for (const Result& ours : results) {
    if (ours.sequence != sequence || ours.system != system) continue;
    for (const Result& theirs : results)
      if (theirs.sequence == sequence && theirs.system == peer && theirs.repeat == ours.repeat)
        ratios.push_back(ours.cpu_median_ms / theirs.cpu_median_ms);
  }
  return median(ratios);
}

Status write_report(const Report& report, const std::vector<Result>& results, const Host& host,
                    const std::filesystem::path& out) {
  std::vector<std::string> notes = report.notes;
  notes.push_back(host.to_line());
  std::string markdown = to_markdown(report.table);
  for (const Table& table : report.more) markdown += '\n' + to_markdown(table);
  for (const std::string& note : notes) markdown += '\n' + note + '\n';

  nlohmann::ordered_json json = {{"title", report.title}, {"host", host.to_json()}};
  for (const Result& result : results)
    json["results"].push_back(to_json(
        result, {{"sequence", result.sequence}, {"system", result.system}, {"repeat", result.repeat}}));

  const auto file = [&](const char* extension) { return out / (report.name + extension); };
  if (Status status = write_text(file(".md"), markdown); !status.ok()) return status;
  if (Status status = write_text(file(".csv"), to_csv(report.exact)); !status.ok()) return status;
  if (Status status = write_text(file(".json"), json.dump(2) + '\n'); !status.ok()) return status;
  if (Status status = write_text(file(".html"), to_html(report.title, report.table, notes)); !status.ok())
    return status;
  return print(markdown);
}

}  // namespace plvo::bench
