// SPDX-License-Identifier: Apache-2.0
// plvo_bench: compares plvo with its peers. docs/developer/bench.md.
#include <fmt/format.h>

#include <exception>
#include <map>
#include <sstream>

#include "plvo/bench/commands.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {

void add_measuring_options(CLI::App& command, JobOptions& options) {
  const std::map<std::string, eval::GroundTruthSampling> samplings = {
      {"interpolated", eval::GroundTruthSampling::kInterpolated},
      {"nearest", eval::GroundTruthSampling::kNearest}};
  command.add_option("--frames", options.frames, "Only the first N")->type_name("NUMBER");
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
  add_list(command, "--systems", options.systems,
           "all, ours, paper, peers, opencv, open3d, or names as the tables show them; separated by commas");
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

void add_list(CLI::App& command, const std::string& name, std::vector<std::string>& words,
              const std::string& what) {
  command.add_option(name, words, fmt::format("{} (default {})", what, fmt::join(words, ",")))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST");
}

Status make_out(const std::filesystem::path& out) {
  std::error_code error;
  std::filesystem::create_directories(out / "jobs", error);
  if (error) return {StatusCode::kIo, fmt::format("{}: {}", out.string(), error.message())};
  return {};
}

int fail(std::string_view message) {
  print_to_stderr(fmt::format("plvo_bench: error: {}\n", printable(message)));
  return 1;
}

int finish(const Status& status) {
  if (status.ok()) return 0;
  return fail(status.message());
}

}  // namespace plvo::bench

int main(int argc, char** argv) {
  plvo::ignore_broken_outputs();
  plvo::hold_standard_streams();
  CLI::App app("Compares plvo with its peers", "plvo_bench");
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
    std::ostringstream out, err;
    const bool helped = app.exit(error, out, err) == 0;
    plvo::print_to_stderr(err.str());
    return helped ? plvo::bench::finish(plvo::print(out.str())) : 2;
  } catch (const std::exception& error) {  // OpenCV speaks through exceptions
    return plvo::bench::fail(error.what());
  }
  return exit_code;
}
