// SPDX-License-Identifier: Apache-2.0
// plvo_bench lighting: the protocol of Lu & Song's Table 1 on simulated closed sequences. Each site is
// rendered twice from every seed: under constant light and under a lamp that swings and dims. A sequence ends
// where it began, so that the end-point drift (TED) needs no other ground truth. The unit of work is one
// sequence: render its images if they do not exist yet, then measure every system.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/jobs/campaign.hpp"
#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/lighting/lighting_table.hpp"
#include "plvo/bench/sequences/rendered_sequence.hpp"
#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

struct LightingOptions {
  CommonOptions common;
  std::vector<std::string> sites = {"corridor", "staircase", "hall", "desk", "bare"};
  std::vector<std::string> lights = {"constant", "varying"};
  int seeds = 3;
  int first_seed = 1;
  int frames = 180;
  fs::path sequences;  // folder of the images; empty: out/sequences
  bool render_only = false;
  bool discard_images = false;

  fs::path images_folder() const {
    return fs::absolute(sequences.empty() ? common.out / "sequences" : sequences);
  }
};

std::string name_of(const LitSequence& sequence) {
  return fmt::format("{}_{}_{}_{}f", sequence.site, sequence.light, sequence.seed, sequence.frames);
}

fs::path folder_of(const LitSequence& sequence, const LightingOptions& options) {
  return options.images_folder() / sequence.name;
}

Status list_sequences(const LightingOptions& options, std::vector<LitSequence>& sequences) {
  for (const std::string& site : options.sites) {
    SceneName scene{};
    if (Status status = parse_scene(site, scene); !status.ok()) return status;
    for (const std::string& light : options.lights) {
      LightName name{};
      if (Status status = parse_light(light, name); !status.ok()) return status;
      for (int i = 0; i < options.seeds; ++i) {
        LitSequence sequence{site, light, options.first_seed + i, options.frames, {}};
        sequence.name = name_of(sequence);
        sequences.push_back(sequence);
      }
    }
  }
  return {};
}

Status render(const LitSequence& sequence, const fs::path& folder) {
  SimulatorOptions options;
  options.seed = static_cast<std::uint64_t>(sequence.seed);
  options.frames = sequence.frames;
  options.threads = 1;  // --jobs provides the parallelism
  if (Status status = parse_scene(sequence.site, options.scene); !status.ok()) return status;
  if (Status status = parse_light(sequence.light, options.light); !status.ok()) return status;
  return render_sequence(options, folder);
}

std::vector<Job> jobs_of(const LitSequence& sequence, const std::vector<std::string>& systems,
                         const LightingOptions& options) {
  return interleaved_jobs({{folder_of(sequence, options), sequence.name, ""}}, systems,
                          options.common.repeats, options.common.measuring);
}

// Returns the command line that processes only this sequence.
std::vector<std::string> command_of(const LitSequence& sequence, const LightingOptions& options) {
  std::vector<std::string> words = {own_program(),  "sequence",
                                    "--out",        fs::absolute(options.common.out).string(),
                                    "--sites",      sequence.site,
                                    "--lights",     sequence.light,
                                    "--first-seed", std::to_string(sequence.seed),
                                    "--seeds",      "1",
                                    "--frames",     std::to_string(sequence.frames),
                                    "--systems",    fmt::format("{}", fmt::join(options.common.systems, ",")),
                                    "--sequences",  options.images_folder().string(),
                                    "--repeats",    std::to_string(options.common.repeats)};
  if (options.render_only) words.push_back("--render-only");
  if (options.discard_images) words.push_back("--discard-images");
  return words;
}

bool is_done(const LitSequence& sequence, const std::vector<Job>& jobs, const LightingOptions& options) {
  std::error_code error;
  if (options.render_only) return fs::is_directory(folder_of(sequence, options), error);
  return missing_jobs(jobs, options.common.out).empty();
}

Status sequences_alone(const LightingOptions& options) {
  std::vector<LitSequence> sequences;
  std::vector<std::string> systems;
  if (Status status = list_sequences(options, sequences); !status.ok()) return status;
  if (Status status = parse_systems(options.common.systems, systems); !status.ok()) return status;
  if (Status status = make_out(options.common.out); !status.ok()) return status;
  for (const LitSequence& sequence : sequences) {
    const std::vector<Job> jobs = jobs_of(sequence, systems, options);
    if (is_done(sequence, jobs, options)) continue;
    const fs::path folder = folder_of(sequence, options);
    if (Status status = render(sequence, folder); !status.ok()) return status;
    if (options.render_only) continue;
    std::vector<std::vector<std::string>> commands;
    std::vector<std::string> names;
    for (const Job& job : missing_jobs(jobs, options.common.out)) {
      commands.push_back(job.command(own_program(), fs::absolute(options.common.out)));
      names.push_back(fmt::format("{} {}", job.sequence, job.system));
    }
    if (Status status = run_and_report(commands, names, 1); !status.ok()) return status;
    std::error_code error;
    if (options.discard_images) fs::remove_all(folder, error);
  }
  return {};
}

Status run_lighting(const LightingOptions& options) {
  const CommonOptions& common = options.common;
  std::vector<LitSequence> sequences;
  std::vector<std::string> systems;
  if (Status status = list_sequences(options, sequences); !status.ok()) return status;
  if (Status status = parse_systems(common.systems, systems); !status.ok()) return status;
  if (Status status = make_out(common.out); !status.ok()) return status;
  std::vector<Job> all;
  std::vector<std::vector<std::string>> commands;
  std::vector<std::string> names;
  for (const LitSequence& sequence : sequences) {
    const std::vector<Job> jobs = jobs_of(sequence, systems, options);
    all.insert(all.end(), jobs.begin(), jobs.end());
    if (is_done(sequence, jobs, options)) continue;
    commands.push_back(command_of(sequence, options));
    names.push_back(sequence.name);
  }
  if (common.list_jobs) return print_jobs(commands);
  const Host host = describe_host();
  const Status ran = run_and_report(commands, names, common.jobs);
  if (options.render_only) return ran;
  const std::vector<Result> results = read_results(all, common.out);
  if (Status status = write_report(lighting_report(sequences, systems, results), results, host, common.out);
      !status.ok())
    return status;
  return ran;
}

void add_command(CLI::App& app, int& exit_code, const char* name, const char* what,
                 Status (*execute)(const LightingOptions&)) {
  auto options = std::make_shared<LightingOptions>();
  CLI::App* command = app.add_subcommand(name, what);
  options->common.systems = {"ours", "peers"};
  add_common_options(*command, options->common);
  add_list(*command, "--sites", options->sites, "Scenes of the simulator");
  add_list(*command, "--lights", options->lights, "Lights of the simulator");
  command->add_option("--seeds", options->seeds, "Sequences of each site and light (default 3)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->add_option("--first-seed", options->first_seed, "Default 1")->type_name("NUMBER");
  command->add_option("--frames", options->frames, "Of each sequence, at 30 Hz (default 180)")
      ->check(CLI::Range(2, 1'000'000).description(""))
      ->type_name("NUMBER");
  command->add_option("--sequences", options->sequences, "Where the images are (default: sequences in --out)")
      ->type_name("DIR");
  auto* render_only =
      command->add_flag("--render-only", options->render_only, "Render the sequences and measure nothing");
  auto* discard = command->add_flag(
      "--discard-images", options->discard_images,
      "Remove a sequence's images when it is measured; they can be rendered again, bit by bit alike");
  render_only->excludes(discard);
  command->callback([options, execute, &exit_code] { exit_code = finish(execute(*options)); });
}

}  // namespace

void add_lighting(CLI::App& app, int& exit_code) {
  add_command(app, exit_code, "lighting",
              "The paper's Table 1 on simulated sequences: drift under two lights", run_lighting);
  add_command(app, exit_code, "sequence",
              "Sequences alone, without the tables, as lighting --list-jobs prints them", sequences_alone);
}

}  // namespace plvo::bench
