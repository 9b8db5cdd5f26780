// SPDX-License-Identifier: Apache-2.0
// plvo_bench stages: measures the CPU time of each stage and, with --instructions, the instructions of each
// step over the same frames, which come from a folder or from a sequence that is rendered once.
#include <fmt/core.h>

#include <fstream>
#include <map>
#include <memory>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/sequences/named_folder.hpp"
#include "plvo/bench/sequences/rendered_sequence.hpp"
#include "plvo/bench/stages/callgrind_run.hpp"
#include "plvo/bench/stages/stage_instructions.hpp"
#include "plvo/bench/stages/stage_times.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

struct StagesOptions {
  std::string folder;
  fs::path out;
  JobOptions measuring;
  StageSetting setting;
  bool instructions = false;
  bool without_table = false;
};

Table times_table(const StageTimes& times) {
  Table table;
  table.header = {"stage", "median ms", "p95 ms", "max ms"};
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    const eval::Statistics s = eval::statistics(values);
    table.rows.push_back({name, cell(s.median, 2), cell(s.p95, 2), cell(s.max, 2)});
  };
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    add(to_string(static_cast<Stage>(stage)), times.stage_ms[stage]);
  add("frame", times.frame_ms);
  return table;
}

Status count_instructions(const NamedFolder& sequence, const StagesOptions& options, const fs::path& profile,
                          CallgrindCosts& costs) {
  std::vector<std::string> command;
  if (Status status = callgrind_command(sequence, options.measuring, options.setting, profile,
                                        ProfileOf::kAllFrames, command);
      !status.ok())
    return status;
  const auto ended = [](std::size_t, bool, std::size_t) {};
  if (run_commands({command}, 1, ended) != 0) return {StatusCode::kIo, "the run under valgrind failed"};
  std::ifstream file(profile);
  costs = read_callgrind(file);
  if (costs.total == 0)
    return {StatusCode::kDamaged, fmt::format("{}: nothing was counted", profile.string())};
  return {};
}

Status run_stages(const StagesOptions& options) {
  if (Status status = make_out(options.out); !status.ok()) return status;
  NamedFolder sequence;
  if (options.folder.empty()) {
    const std::string name = fmt::format("simulated_{}f", options.measuring.frames);
    sequence = {options.out / name, name, ""};
    SimulatorOptions rendering;
    rendering.frames = static_cast<int>(options.measuring.frames);
    if (Status status = render_sequence(rendering, sequence.folder); !status.ok()) return status;
  } else {
    std::vector<NamedFolder> named;
    if (Status status = name_folders({options.folder}, named); !status.ok()) return status;
    sequence = named.front();
  }
  StageTimes times;
  if (Status status = measure_stages(sequence, options.measuring, options.setting, times); !status.ok())
    return status;
  if (options.without_table) return {};
  if (times.frame_ms.empty()) return {StatusCode::kTooFewFeatures, "there is only one frame"};
  std::string text = fmt::format("{}: {} frames, {} lost\n\n{}", sequence.sequence, times.frame_ms.size(),
                                 times.lost, to_markdown(times_table(times)));
  if (options.instructions) {
    const fs::path profile = options.out / (sequence.sequence + ".callgrind");
    CallgrindCosts costs;
    if (Status status = count_instructions(sequence, options, profile, costs); !status.ok()) return status;
    text += '\n' + to_markdown(instructions_table(costs, times.frame_ms.size()));
  }
  if (Status status = write_text(options.out / "stages.md", text); !status.ok()) return status;
  return print(text);
}

}  // namespace

void add_stages(CLI::App& app, int& exit_code) {
  const std::map<std::string, Replacement> replacements = {{"own", Replacement::kRecorded},
                                                           {"noise", Replacement::kNoise},
                                                           {"stripes", Replacement::kStripes},
                                                           {"checkerboard", Replacement::kCheckerboard}};
  auto options = std::make_shared<StagesOptions>();
  options->measuring.frames = 20;
  CLI::App* command =
      app.add_subcommand("stages", "Where a frame's time goes: CPU and instructions by stage");
  command->add_option("folder", options->folder, "A sequence in TUM's layout (default: a simulated sequence)")
      ->type_name("DIR[=MODEL]");
  command->add_option("--out", options->out, "For the table, the profile and the sequence")
      ->required()
      ->type_name("DIR");
  command->add_flag("--instructions", options->instructions,
                    "Count the instructions of each step, under valgrind (slow)");
  command
      ->add_option("--image", options->setting.replacement,
                   "own (default), or what is hardest: noise, stripes, checkerboard")
      ->transform(CLI::CheckedTransformer(replacements).description(""))
      ->type_name("WHAT");
  command->add_flag_callback(
      "--tiny", [options] { options->setting.make_tiny(); },
      "As plvo run --preset tiny, but for --keypoints, --segments and --surfaces where they are given");
  command
      ->add_option("--keypoints", options->setting.keypoints,
                   fmt::format("Capacity (default {})", options->setting.keypoints))
      ->type_name("NUMBER");
  command
      ->add_option("--segments", options->setting.segments,
                   fmt::format("Capacity (default {})", options->setting.segments))
      ->type_name("NUMBER");
  command
      ->add_option("--surfaces", options->setting.surfaces,
                   fmt::format("So many samples a frame (default {})", options->setting.surfaces))
      ->type_name("NUMBER");
  command->add_flag("--without-table", options->without_table, "As callgrind runs it")->group("");
  add_measuring_options(*command, options->measuring);
  command->callback([options, &exit_code] { exit_code = finish(run_stages(*options)); });
}

}  // namespace plvo::bench
