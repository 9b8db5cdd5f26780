// SPDX-License-Identifier: Apache-2.0
// plvo_bench: plvo and its peers side by side. docs/bench.md.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <map>

#include "plvo/bench/commands.hpp"

namespace plvo::bench {

void add_measuring_options(CLI::App& command, JobOptions& options) {
  const std::map<std::string, eval::GroundTruthSampling> samplings = {
      {"interpolated", eval::GroundTruthSampling::kInterpolated},
      {"nearest", eval::GroundTruthSampling::kNearest}};
  command.add_option("--frames", options.frames, "Only the first so many")->type_name("NUMBER");
  command
      .add_option("--camera-model", options.camera_model, "A camera by name, instead of each calibration.txt")
      ->type_name("NAME");
  command.add_option("--gt-sampling", options.sampling, "interpolated, or nearest as TUM's scripts do")
      ->transform(CLI::CheckedTransformer(samplings).description(""))
      ->type_name("HOW");
}

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("--out", options.out, "Results and tables; what is there already is not measured again")
      ->required()
      ->type_name("DIR");
  command
      .add_option(
          "--systems", options.systems,
          "all, ours, paper, peers, opencv, open3d, or names as the tables show them; separated by commas")
      ->type_name("LIST");
  command.add_option("--repeats", options.repeats, "Each job so often, interleaved (default 1)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command.add_option("--jobs", options.jobs, "Processes at a time (default 1: times are best alone)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command.add_flag("--list-jobs", options.list_jobs,
                   "Only print the commands that are still to run, one a line; afterwards, the same command "
                   "without this makes the tables");
}

Status make_out(const std::filesystem::path& out) {
  std::error_code error;
  std::filesystem::create_directories(out / "jobs", error);
  if (error) return {StatusCode::kIo, fmt::format("{}: {}", out.string(), error.message())};
  return {};
}

int finish(const Status& status) {
  if (status.ok()) return 0;
  fmt::print(stderr, "plvo_bench: error: {}\n", status.message());
  return 1;
}

}  // namespace plvo::bench

int main(int argc, char** argv) {
  CLI::App app("plvo and its peers, side by side", "plvo_bench");
  app.require_subcommand(1);
  int exit_code = 0;
  plvo::bench::add_sequences(app, exit_code);
  plvo::bench::add_lighting(app, exit_code);
  plvo::bench::add_stages(app, exit_code);
  plvo::bench::add_growth(app, exit_code);
  plvo::bench::add_detectors(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {  // OpenCV speaks through exceptions
    fmt::print(stderr, "plvo_bench: error: {}\n", error.what());
    return 1;
  }
  return exit_code;
}
