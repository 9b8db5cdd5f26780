// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/growth/growth_measure.hpp"

#include <fmt/core.h>

#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/sequences/rendered_sequence.hpp"
#include "plvo/bench/stages/callgrind_run.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

JobOptions measuring(const GrowthCase& one) {
  JobOptions options;
  options.frames = one.frames;
  return options;
}

std::string describe(const GrowthCase& one) {
  return fmt::format("{}, capacity for {} keypoints, {} segments", one.sequence.sequence,
                     one.setting.keypoints, one.setting.segments);
}

Status render(const GrowthPlan& plan) {
  for (const GrowthCase& one : plan.cases) {
    std::error_code error;
    if (!one.rendering || fs::is_directory(one.sequence.folder, error)) continue;
    print_to_stderr(fmt::format("rendering {}\n", one.sequence.sequence));
    if (Status status = render_sequence(*one.rendering, one.sequence.folder); !status.ok()) return status;
  }
  return {};
}

Status measure_times(const GrowthPlan& plan, int repeats, std::vector<GrowthResult>& results) {
  for (int repeat = 0; repeat < repeats; ++repeat) {
    print_to_stderr(fmt::format("CPU time, repeat {} of {}\n", repeat + 1, repeats));
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
      const GrowthCase& one = plan.cases[i];
      StageTimes times;
      if (Status status = measure_stages(one.sequence, measuring(one), one.setting, times); !status.ok())
        return status;
      if (times.frame_ms.empty())
        return {StatusCode::kTooFewFeatures,
                fmt::format("{}: there is only one frame", one.sequence.sequence)};
      results[i].times.push_back(times);
    }
  }
  return {};
}

Status count(const GrowthPlan& plan, const GrowthOptions& options, std::vector<GrowthResult>& results) {
  const fs::path profiles = options.out / "profiles";
  std::error_code error;
  fs::remove_all(profiles, error);
  std::vector<std::vector<std::string>> commands(plan.cases.size());
  const auto profile = [&](std::size_t i) { return profiles / std::to_string(i) / "callgrind"; };
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const GrowthCase& one = plan.cases[i];
    fs::create_directories(profile(i).parent_path(), error);
    if (error) return {StatusCode::kIo, fmt::format("{}: {}", profile(i).string(), error.message())};
    if (Status status = callgrind_command(one.sequence, measuring(one), one.setting, profile(i),
                                          ProfileOf::kEachFrame, commands[i]);
        !status.ok())
      return status;
  }
  const std::size_t failed =
      run_commands(commands, options.jobs, [&](std::size_t i, bool success, std::size_t ended) {
        print_to_stderr(fmt::format("[{}/{}] instructions: {}{}\n", ended, commands.size(),
                                    describe(plan.cases[i]), success ? "" : ": FAILED"));
      });
  if (failed != 0) return {StatusCode::kIo, fmt::format("{} runs under valgrind failed", failed)};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    std::vector<CallgrindCosts> frames;
    if (Status status = read_frame_profiles(profile(i), frames); !status.ok()) return status;
    for (const CallgrindCosts& costs : frames) results[i].frames.push_back(stage_instructions(costs));
  }
  fs::remove_all(profiles, error);
  return {};
}

}  // namespace

Status measure_growth(const GrowthPlan& plan, const GrowthOptions& options,
                      std::vector<GrowthResult>& results) {
  results.assign(plan.cases.size(), {});
  if (Status status = render(plan); !status.ok()) return status;
  if (Status status = measure_times(plan, options.repeats, results); !status.ok()) return status;
  return count(plan, options, results);
}

}  // namespace plvo::bench
