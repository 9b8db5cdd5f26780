// SPDX-License-Identifier: Apache-2.0
// plvo_bench run and tum measure several systems on recorded sequences. Only their tables differ: run gives
// all values, tum the paper's Table 2, with means weighted by the number of frames.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <set>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/jobs/campaign.hpp"
#include "plvo/bench/jobs/measure.hpp"
#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/sequences/named_folder.hpp"
#include "plvo/bench/sequences/paper_table2.hpp"
#include "plvo/bench/systems/system.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPeer = "opencv-rgbd";  // its time is the unit of the last column
constexpr const char* kMean = "mean, weighted by frames";
constexpr int kExactDecimals = 6;

// Puts a row of the zero-motion baseline before the systems of each sequence.
template <typename MakeRow>
void add_rows(const std::vector<Result>& merged, MakeRow make_row, Table& table) {
  std::string sequence;
  for (const Result& result : merged) {
    if (result.sequence != sequence) {
      Result identity = result;
      identity.system = kIdentity;
      identity.estimate = result.identity;
      identity.lost = 0;
      identity.cpu_median_ms = identity.cpu_p95_ms = identity.growth_mb = identity.peak_mb = kNone;
      table.rows.push_back(make_row(identity));
    }
    sequence = result.sequence;
    table.rows.push_back(make_row(result));
  }
}

// decimals: added to the number of decimals of each column.
Table comparison_table(const std::vector<Result>& results, int decimals) {
  Table table;
  table.header = {
      "sequence", "system", "mm/s",          "°/s",        "mm/frame", "°/frame",    "ATE mm",
      "TED mm",   "lost",   "median CPU ms", "p95 CPU ms", "own MB",   "process MB", "time / RgbdOdometry"};
  table.text_columns = 2;
  const auto row = [&](const Result& r) -> std::vector<std::string> {
    const Accuracy& a = r.estimate;
    return {r.sequence,
            r.system,
            cell(a.rpe_second_mm, 1 + decimals),
            cell(a.rpe_second_deg, 2 + decimals),
            cell(a.rpe_frame_mm, 2 + decimals),
            cell(a.rpe_frame_deg, 3 + decimals),
            cell(a.ate_mm, 1 + decimals),
            cell(a.ted_mm, 1 + decimals),
            r.system == kIdentity ? "–" : fmt::format("{}/{}", r.lost, r.frames),
            cell(r.cpu_median_ms, 1 + decimals),
            cell(r.cpu_p95_ms, 1 + decimals),
            cell(r.growth_mb, 1 + decimals),
            cell(r.peak_mb, 1 + decimals),
            cell(relative_cpu(results, r.sequence, r.system, kPeer), 2 + decimals)};
  };
  add_rows(merge_repeats(results), row, table);
  return table;
}

std::vector<Result> with_weighted_means(const std::vector<Result>& merged) {
  std::vector<Result> all = merged;
  std::vector<std::string> systems;
  for (const Result& r : merged)
    if (std::find(systems.begin(), systems.end(), r.system) == systems.end()) systems.push_back(r.system);
  for (const std::string& system : systems) {
    Result mean;
    mean.sequence = kMean;
    mean.system = system;
    const auto add = [](Accuracy& sum, const Accuracy& a, double weight) {
      sum.rpe_frame_mm += weight * a.rpe_frame_mm;
      sum.rpe_frame_deg += weight * a.rpe_frame_deg;
      sum.rpe_second_mm += weight * a.rpe_second_mm;
      sum.rpe_second_deg += weight * a.rpe_second_deg;
    };
    for (const Result& r : merged)
      if (r.system == system) mean.frames += r.frames;
    for (const Result& r : merged) {
      if (r.system != system) continue;
      add(mean.estimate, r.estimate, static_cast<double>(r.frames) / mean.frames);
      add(mean.identity, r.identity, static_cast<double>(r.frames) / mean.frames);
      mean.lost += r.lost;
    }
    all.push_back(mean);
  }
  return all;
}

constexpr int kNotSaid = -1;  // number of lost frames, which the paper does not report

// Inserts the paper's rows: after each fr1 sequence, or part of one, the values for the whole sequence; after
// the means the paper's means, if all nine sequences are present.
std::vector<Result> with_paper(const std::vector<Result>& measured) {
  std::vector<Result> all;
  std::set<std::string> whole;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    all.push_back(measured[i]);
    const std::string& sequence = measured[i].sequence;
    if (i + 1 < measured.size() && measured[i + 1].sequence == sequence) continue;
    const PaperSequence paper = paper_sequence(sequence);
    if (paper.whole) whole.insert(paper.name);
    const bool is_mean = sequence == kMean && whole.size() == paper_sequences().size();
    for (Result row : paper_results(is_mean ? "mean" : paper.name)) {
      row.sequence = sequence;
      if (!is_mean && !paper.whole) row.system += ", all of fr1/" + paper.name;
      row.lost = kNotSaid;
      all.push_back(row);
    }
  }
  return all;
}

Table tum_table(const std::vector<Result>& results, int decimals) {
  Table table;
  table.header = {"sequence", "system", "frames", "lost", "mm/frame", "°/frame", "mm/s", "°/s"};
  table.text_columns = 2;
  const auto row = [&](const Result& r) -> std::vector<std::string> {
    const Accuracy& a = r.estimate;
    return {r.sequence,
            r.system,
            std::to_string(r.frames),
            r.system == kIdentity || r.lost == kNotSaid ? "–" : std::to_string(r.lost),
            cell(a.rpe_frame_mm, 1 + decimals),
            cell(a.rpe_frame_deg, 2 + decimals),
            cell(a.rpe_second_mm, 1 + decimals),
            cell(a.rpe_second_deg, 2 + decimals)};
  };
  add_rows(with_paper(with_weighted_means(merge_repeats(results))), row, table);
  return table;
}

struct SequencesOptions {
  CommonOptions common;
  std::vector<std::string> folders;
  bool tum = false;
};

Report make_report(const SequencesOptions& options, const std::vector<Result>& results) {
  Report report;
  report.notes = {fmt::format(
      "RMSE over all pairs, {} ground truth; a lost frame keeps the last good pose and counts. CPU: one "
      "thread, decoding excluded; peers get their images undistorted, and in the form they take, outside of "
      "the timed part. \"own MB\": resident memory that came after the program was loaded.",
      options.common.measuring.sampling == eval::GroundTruthSampling::kNearest ? "nearest" : "interpolated")};
  if (options.tum) {
    report.name = "table2";
    report.title = "Relative pose error per frame and per second";
    report.table = tum_table(results, 0);
    report.exact = tum_table(results, kExactDecimals);
    report.notes.push_back(
        "\"paper\": Table 2 of Lu & Song (ICCV 2015), each figure over the whole sequence.");
  } else {
    report.name = "comparison";
    report.title = "Comparison";
    report.table = comparison_table(results, 0);
    report.exact = comparison_table(results, kExactDecimals);
  }
  return report;
}

Status run_sequences(const SequencesOptions& options) {
  const CommonOptions& common = options.common;
  std::vector<std::string> systems;
  std::vector<NamedFolder> sequences;
  if (Status status = parse_systems(common.systems, systems); !status.ok()) return status;
  if (Status status = name_folders(options.folders, sequences); !status.ok()) return status;
  if (Status status = make_out(common.out); !status.ok()) return status;
  const std::vector<Job> jobs = interleaved_jobs(sequences, systems, common.repeats, common.measuring);
  std::vector<std::vector<std::string>> commands;
  std::vector<std::string> names;
  for (const Job& job : missing_jobs(jobs, common.out)) {
    commands.push_back(job.command(own_program(), fs::absolute(common.out)));
    names.push_back(fmt::format("{} {} repeat {}", job.sequence, job.system, job.repeat));
  }
  if (common.list_jobs) return print_jobs(commands);
  const Host host = describe_host();
  const Status ran = run_and_report(commands, names, common.jobs);
  const std::vector<Result> results = read_results(jobs, common.out);
  if (Status status = write_report(make_report(options, results), results, host, common.out); !status.ok())
    return status;
  return ran;
}

void add_sequences_command(CLI::App& app, int& exit_code, bool tum) {
  auto options = std::make_shared<SequencesOptions>();
  options->tum = tum;
  CLI::App* command =
      tum ? app.add_subcommand("tum", "The paper's Table 2 over TUM folders: RPE and its frame-weighted mean")
          : app.add_subcommand("run", "Every system over every sequence: accuracy, time, memory");
  command
      ->add_option("folders", options->folders,
                   "Recorded folders, as plvo run takes them, with ground truth; DIR=MODEL names the camera")
      ->required()
      ->type_name("DIR[=MODEL]");
  add_common_options(*command, options->common);
  add_measuring_options(*command, options->common.measuring);
  command->callback([options, &exit_code] { exit_code = finish(run_sequences(*options)); });
}

void add_worker(CLI::App& app, int& exit_code) {
  struct WorkerOptions {
    Job job;
    fs::path out;
  };
  auto options = std::make_shared<WorkerOptions>();
  CLI::App* command = app.add_subcommand("worker", "One job, as --list-jobs prints it");
  command->add_option("--folder", options->job.folder)->required();
  command->add_option("--sequence", options->job.sequence)->required();
  command->add_option("--system", options->job.system)->required();
  command->add_option("--repeat", options->job.repeat);
  command->add_option("--out", options->out)->required();
  add_measuring_options(*command, options->job.options);
  command->callback([options, &exit_code] { exit_code = finish(measure(options->job, options->out)); });
}

}  // namespace

void add_sequences(CLI::App& app, int& exit_code) {
  add_sequences_command(app, exit_code, false);
  add_sequences_command(app, exit_code, true);
  add_worker(app, exit_code);
}

}  // namespace plvo::bench
