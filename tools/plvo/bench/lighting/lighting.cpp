// SPDX-License-Identifier: Apache-2.0
// plvo_bench lighting: the protocol of Lu & Song's Table 1 on simulated closed walks. Each site is walked
// twice from every seed: under constant light and under a lamp that swings and dims. A walk ends where it
// began, so that the end-point drift (TED) needs no other ground truth. The unit of work is one walk: render
// its images if they do not exist yet, then measure every system.
#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <sstream>

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
  std::string sites = "corridor,staircase,hall,desk,bare";
  std::string lights = "constant,varying";
  int seeds = 3;
  int first_seed = 1;
  int frames = 180;
  fs::path walks;  // folder of the images; empty: out/walks
  bool render_only = false;
  bool discard_images = false;

  fs::path walks_folder() const { return fs::absolute(walks.empty() ? common.out / "walks" : walks); }
};

std::string walk_name(const Walk& walk) {
  return fmt::format("{}_{}_{}_{}f", walk.site, walk.light, walk.seed, walk.frames);
}

fs::path walk_folder(const Walk& walk, const LightingOptions& options) {
  return options.walks_folder() / walk.sequence;
}

Status list_walks(const LightingOptions& options, std::vector<Walk>& walks) {
  std::stringstream sites(options.sites);
  for (std::string site; std::getline(sites, site, ',');) {
    SceneName scene{};
    if (Status status = parse_scene(site, scene); !status.ok()) return status;
    std::stringstream lights(options.lights);
    for (std::string light; std::getline(lights, light, ',');) {
      LightName name{};
      if (Status status = parse_light(light, name); !status.ok()) return status;
      for (int i = 0; i < options.seeds; ++i) {
        Walk walk{site, light, options.first_seed + i, options.frames, {}};
        walk.sequence = walk_name(walk);
        walks.push_back(walk);
      }
    }
  }
  return {};
}

Status render(const Walk& walk, const fs::path& folder) {
  SimulatorOptions options;
  options.seed = static_cast<std::uint64_t>(walk.seed);
  options.frames = walk.frames;
  options.threads = 1;  // --jobs provides the parallelism
  if (Status status = parse_scene(walk.site, options.scene); !status.ok()) return status;
  if (Status status = parse_light(walk.light, options.light); !status.ok()) return status;
  return render_sequence(options, folder);
}

std::vector<Job> jobs_of(const Walk& walk, const std::vector<std::string>& systems,
                         const LightingOptions& options) {
  return interleaved_jobs({{walk_folder(walk, options), walk.sequence, ""}}, systems, options.common.repeats,
                          options.common.measuring);
}

// Returns the command line that processes only this walk.
std::vector<std::string> walk_command(const Walk& walk, const LightingOptions& options) {
  std::vector<std::string> words = {own_program(),  "walk",
                                    "--out",        fs::absolute(options.common.out).string(),
                                    "--sites",      walk.site,
                                    "--lights",     walk.light,
                                    "--first-seed", std::to_string(walk.seed),
                                    "--seeds",      "1",
                                    "--frames",     std::to_string(walk.frames),
                                    "--systems",    options.common.systems,
                                    "--walks",      options.walks_folder().string(),
                                    "--repeats",    std::to_string(options.common.repeats)};
  if (options.render_only) words.push_back("--render-only");
  if (options.discard_images) words.push_back("--discard-images");
  return words;
}

bool is_done(const Walk& walk, const std::vector<Job>& jobs, const LightingOptions& options) {
  std::error_code error;
  if (options.render_only) return fs::is_directory(walk_folder(walk, options), error);
  return missing_jobs(jobs, options.common.out).empty();
}

Status walk_alone(const LightingOptions& options) {
  std::vector<Walk> walks;
  std::vector<std::string> systems;
  if (Status status = list_walks(options, walks); !status.ok()) return status;
  if (Status status = parse_systems(options.common.systems, systems); !status.ok()) return status;
  if (Status status = make_out(options.common.out); !status.ok()) return status;
  for (const Walk& walk : walks) {
    const std::vector<Job> jobs = jobs_of(walk, systems, options);
    if (is_done(walk, jobs, options)) continue;
    const fs::path folder = walk_folder(walk, options);
    if (Status status = render(walk, folder); !status.ok()) return status;
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
  std::vector<Walk> walks;
  std::vector<std::string> systems;
  if (Status status = list_walks(options, walks); !status.ok()) return status;
  if (Status status = parse_systems(common.systems, systems); !status.ok()) return status;
  if (Status status = make_out(common.out); !status.ok()) return status;
  std::vector<Job> all;
  std::vector<std::vector<std::string>> commands;
  std::vector<std::string> names;
  for (const Walk& walk : walks) {
    const std::vector<Job> jobs = jobs_of(walk, systems, options);
    all.insert(all.end(), jobs.begin(), jobs.end());
    if (is_done(walk, jobs, options)) continue;
    commands.push_back(walk_command(walk, options));
    names.push_back(walk.sequence);
  }
  if (common.list_jobs) return print_jobs(commands);
  const Host host = describe_host();
  const Status ran = run_and_report(commands, names, common.jobs);
  if (options.render_only) return ran;
  const std::vector<Result> results = read_results(all, common.out);
  if (Status status = write_report(lighting_report(walks, systems, results), results, host, common.out);
      !status.ok())
    return status;
  return ran;
}

void add_command(CLI::App& app, int& exit_code, const char* name, const char* what,
                 Status (*execute)(const LightingOptions&)) {
  auto options = std::make_shared<LightingOptions>();
  CLI::App* command = app.add_subcommand(name, what);
  options->common.systems = "ours,peers";
  add_common_options(*command, options->common);
  command->add_option("--sites", options->sites, "Default: " + options->sites)->type_name("LIST");
  command->add_option("--lights", options->lights, "Default: " + options->lights)->type_name("LIST");
  command->add_option("--seeds", options->seeds, "Walks of each site and light (default 3)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command->add_option("--first-seed", options->first_seed, "Default 1")->type_name("NUMBER");
  command->add_option("--frames", options->frames, "Of each walk, at 30 Hz (default 180)")
      ->check(CLI::Range(2, 1'000'000).description(""))
      ->type_name("NUMBER");
  command->add_option("--walks", options->walks, "Where the images are (default: walks in --out)")
      ->type_name("DIR");
  auto* render_only =
      command->add_flag("--render-only", options->render_only, "Render the walks and measure nothing");
  auto* discard = command->add_flag(
      "--discard-images", options->discard_images,
      "Remove a walk's images when it is measured; they can be rendered again, bit by bit alike");
  render_only->excludes(discard);
  command->callback([options, execute, &exit_code] { exit_code = finish(execute(*options)); });
}

}  // namespace

void add_lighting(CLI::App& app, int& exit_code) {
  add_command(app, exit_code, "lighting", "The paper's Table 1 on simulated walks: drift under two lights",
              run_lighting);
  add_command(app, exit_code, "walk", "Walks alone, without the tables, as lighting --list-jobs prints them",
              walk_alone);
}

}  // namespace plvo::bench
