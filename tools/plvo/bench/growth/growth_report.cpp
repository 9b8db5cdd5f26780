// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/growth/growth_report.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/bench/jobs/campaign.hpp"
#include "plvo/eval/statistics.hpp"

namespace plvo::bench {
namespace {

std::vector<double> instructions(const GrowthResult& result) {
  std::vector<double> all;
  for (const StageInstructions& frame : result.frames) all.push_back(static_cast<double>(frame.all));
  std::sort(all.begin(), all.end());
  return all;
}

double mean_instructions(const GrowthResult& result) { return eval::statistics(instructions(result)).mean; }

// Median over the repeats of the CPU time ratio within a repeat.
double cpu_ratio(const GrowthResult& result, const GrowthResult& reference) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < result.times.size(); ++i)
    ratios.push_back(median(result.times[i].frame_ms) / median(reference.times[i].frame_ms));
  return median(ratios);
}

std::string millions(double value) { return cell(value * 1e-6, 1); }

Table growth_table(const GrowthTable& shown, const std::vector<GrowthResult>& results) {
  const GrowthResult& reference = results.front();
  Table table;
  table.header = {shown.first_column, "keypoints", "segments"};
  for (int stage = 0; stage < kStageCount; ++stage)
    table.header.push_back(to_string(static_cast<Stage>(stage)));
  table.header.insert(table.header.end(), {"rest", "all", "× default", "CPU ×"});
  for (const GrowthTable::Row& shown_row : shown.rows) {
    const GrowthResult& result = results[shown_row.measured];
    const double frames = static_cast<double>(result.frames.size());
    std::vector<std::string> row = {shown_row.name,
                                    cell(eval::statistics(result.times.front().points).mean, 0),
                                    cell(eval::statistics(result.times.front().segments).mean, 0)};
    double rest = mean_instructions(result);
    for (std::size_t stage = 0; stage < kStageCount; ++stage) {
      double sum = 0;
      for (const StageInstructions& frame : result.frames) sum += static_cast<double>(frame.stage[stage]);
      rest -= sum / frames;
      row.push_back(millions(sum / frames));
    }
    row.insert(row.end(), {millions(rest), millions(mean_instructions(result)),
                           cell(mean_instructions(result) / mean_instructions(reference), 2),
                           cell(cpu_ratio(result, reference), 2)});
    table.rows.push_back(row);
  }
  return table;
}

double p99_of_median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return eval::quantile(values, 0.99) / eval::quantile(values, 0.5);
}

Table sequence_table(const GrowthTable& shown, const std::vector<GrowthResult>& results) {
  Table table;
  table.header = {shown.first_column, "frames",          "lost", "median", "p99", "most",
                  "p99 / median",     "CPU p99 / median"};
  for (const GrowthTable::Row& row : shown.rows) {
    const GrowthResult& result = results[row.measured];
    const std::vector<double> all = instructions(result);
    std::vector<double> cpu;
    for (const StageTimes& times : result.times) cpu.push_back(p99_of_median(times.frame_ms));
    table.rows.push_back({row.name, std::to_string(all.size()), std::to_string(result.times.front().lost),
                          millions(eval::quantile(all, 0.5)), millions(eval::quantile(all, 0.99)),
                          millions(all.back()), cell(p99_of_median(all), 2), cell(median(cpu), 2)});
  }
  return table;
}

std::string verdict(const GrowthPlan::Bound& bound, const std::vector<GrowthResult>& results) {
  const GrowthResult& result = results[bound.measured];
  double value = 0;
  switch (bound.of) {
    case GrowthPlan::Bound::Of::kMeanOfUsual:
      value = mean_instructions(result) / mean_instructions(results.front());
      break;
    case GrowthPlan::Bound::Of::kWorstOfUsual:
      value = instructions(result).back() / eval::quantile(instructions(results.front()), 0.5);
      break;
    case GrowthPlan::Bound::Of::kP99OfMedian: value = p99_of_median(instructions(result)); break;
  }
  return fmt::format("- {}: {:.3f}, wanted at most {:.3f}: {}\n", bound.what, value, bound.most,
                     value <= bound.most ? "held" : "NOT held");
}

}  // namespace

std::string growth_report(const GrowthPlan& plan, const std::vector<GrowthResult>& results) {
  std::string text = fmt::format(
      "Millions of instructions a frame, means over {} frames of {}; CPU: medians over {} repeats.\n",
      results.front().frames.size(), plan.cases.front().sequence.sequence, results.front().times.size());
  for (const GrowthTable& table : plan.tables)
    text += fmt::format("\n{}\n\n{}", table.title, to_markdown(growth_table(table, results)));
  if (!plan.sequences.rows.empty())
    text +=
        fmt::format("\n{}\n\n{}", plan.sequences.title, to_markdown(sequence_table(plan.sequences, results)));
  text += '\n';
  for (const GrowthPlan::Bound& bound : plan.bounds) text += verdict(bound, results);
  return text;
}

}  // namespace plvo::bench
