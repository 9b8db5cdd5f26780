// SPDX-License-Identifier: Apache-2.0
// plvo_bench growth: measures how the cost of a frame grows with the image size, with the capacities for
// points and segments and on images that are hard for a detector, and how far the slowest frames of a
// sequence are from its median. See docs/developer/performance.md.
#include <fmt/core.h>

#include <memory>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/growth/growth_report.hpp"
#include "plvo/bench/jobs/host.hpp"
#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/sequences/named_folder.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {
namespace {

struct GrowthArguments {
  GrowthOptions growth;
  std::vector<std::string> folders;
  std::string scene = "desk";
};

Status run_growth(const GrowthArguments& arguments) {
  GrowthOptions options = arguments.growth;
  if (Status status = parse_scene(arguments.scene, options.scene); !status.ok()) return status;
  std::vector<NamedFolder> recorded;
  if (Status status = name_folders(arguments.folders, recorded); !status.ok()) return status;
  GrowthPlan plan;
  if (Status status = plan_growth(options, recorded, plan); !status.ok()) return status;
  if (Status status = make_out(options.out); !status.ok()) return status;
  std::vector<GrowthResult> results;
  if (Status status = measure_growth(plan, options, results); !status.ok()) return status;
  const std::string text = growth_report(plan, results) + '\n' + describe_host().to_line() + '\n';
  if (Status status = write_text(options.out / "growth.md", text); !status.ok()) return status;
  return print(text);
}

}  // namespace

void add_growth(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<GrowthArguments>();
  GrowthOptions& options = arguments->growth;
  CLI::App* command = app.add_subcommand(
      "growth",
      "How a frame's cost grows: with the image, the capacity for features, hard images, along a sequence");
  command
      ->add_option(
          "folders", arguments->folders,
          "Recorded sequences in TUM's layout, for the table of the frames of a sequence (default: none)")
      ->type_name("DIR[=MODEL]");
  command->add_option("--out", options.out, "For growth.md and the sequences, which are rendered once")
      ->required()
      ->type_name("DIR");
  add_list(*command, "--tables", options.tables, "Only these tables");
  command->add_option("--scene", arguments->scene, "Of the rendered sequences (default desk)")
      ->type_name("NAME");
  command->add_option("--frames", options.frames, "Of each case (default 20)")
      ->check(CLI::Range(2, 1'000'000).description(""))
      ->type_name("NUMBER");
  command
      ->add_option(
          "--sequence-frames", options.sequence_frames,
          "Of the rendered and the recorded sequences whose worst frames are looked at (default 150)")
      ->check(CLI::Range(2, 1'000'000).description(""))
      ->type_name("NUMBER");
  command->add_option("--repeats", options.repeats, "Of the CPU times, interleaved (default 3)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->add_option("--jobs", options.jobs, "Processes at a time that count instructions (default 1)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->callback([arguments, &exit_code] { exit_code = finish(run_growth(*arguments)); });
}

}  // namespace plvo::bench
