// SPDX-License-Identifier: Apache-2.0
// plvo_bench stages: where a frame's time goes. CPU time of each stage, and with --instructions the
// instructions of each step, over the same frames: of a folder, or of a walk that is rendered once.
#include <fmt/core.h>

#include <map>
#include <memory>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/sequences/named_folder.hpp"
#include "plvo/bench/stages/stage_instructions.hpp"
#include "plvo/bench/stages/stage_times.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/eval/statistics.hpp"
#include "plvo/simulator/tum_folder.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

struct StagesOptions {
  std::string folder;
  fs::path out;
  JobOptions measuring;
  Replacement replacement = Replacement::kRecorded;
  bool instructions = false;
};

Status render_walk(const fs::path& folder, std::size_t frames) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return {};
  SimulatorOptions options;
  options.frames = static_cast<int>(frames);
  std::unique_ptr<SimulatedCamera> camera;
  if (Status status = SimulatedCamera::create(options, camera); !status.ok()) return status;
  const fs::path part = folder.string() + ".part";
  fs::remove_all(part, error);
  if (Status status = write_tum_folder(*camera, part.string()); !status.ok()) return status;
  fs::rename(part, folder, error);
  if (error) return {StatusCode::kIo, fmt::format("{}: {}", folder.string(), error.message())};
  return {};
}

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

Status run_stages(const StagesOptions& options) {
  if (Status status = make_out(options.out); !status.ok()) return status;
  NamedFolder sequence;
  if (options.folder.empty()) {
    const std::string name = fmt::format("walk_{}f", options.measuring.frames);
    sequence = {options.out / name, name, ""};
    if (Status status = render_walk(sequence.folder, options.measuring.frames); !status.ok()) return status;
  } else {
    std::vector<NamedFolder> named;
    if (Status status = name_folders({options.folder}, named); !status.ok()) return status;
    sequence = named.front();
  }
  StageTimes times;
  if (Status status = measure_stages(sequence, options.measuring, options.replacement, times); !status.ok())
    return status;
  if (times.frame_ms.empty()) return {StatusCode::kTooFewFeatures, "there is only one frame"};
  std::string text = fmt::format("{}: {} frames, {} lost\n\n{}", sequence.sequence, times.frame_ms.size(),
                                 times.lost, to_markdown(times_table(times)));
  if (options.instructions) {
    std::vector<std::string> command = {
        own_program(),
        "stages",
        sequence.camera_model.empty() ? sequence.folder.string()
                                      : fmt::format("{}={}", sequence.folder.string(), sequence.camera_model),
        "--out",
        options.out.string(),
        "--image",
        std::to_string(static_cast<int>(options.replacement)),
        "--frames",
        std::to_string(options.measuring.frames)};
    if (!options.measuring.camera_model.empty())
      command.insert(command.end(), {"--camera-model", options.measuring.camera_model});
    Table table;
    if (Status status =
            count_instructions(command, options.out, sequence.sequence, times.frame_ms.size(), table);
        !status.ok())
      return status;
    text += '\n' + to_markdown(table);
  }
  fmt::print("{}", text);
  return write_text(options.out / "stages.md", text);
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
  command->add_option("folder", options->folder, "A sequence in TUM's layout (default: a simulated walk)")
      ->type_name("DIR[=MODEL]");
  command->add_option("--out", options->out, "For the table, the profile and the walk")
      ->required()
      ->type_name("DIR");
  command->add_flag("--instructions", options->instructions,
                    "Count the instructions of each step, under valgrind (slow)");
  command
      ->add_option("--image", options->replacement,
                   "own (default), or what is hardest: noise, stripes, checkerboard")
      ->transform(CLI::CheckedTransformer(replacements).description(""))
      ->type_name("WHAT");
  add_measuring_options(*command, options->measuring);
  command->callback([options, &exit_code] { exit_code = finish(run_stages(*options)); });
}

}  // namespace plvo::bench
