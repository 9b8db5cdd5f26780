// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/odometry_options.hpp"

#include "plvo/cli/common/arguments.hpp"

namespace plvo::cli {

void add_odometry_options(CLI::App& command, OdometryOptions& options) {
  OptionGroup group(command, "Odometry");
  group.choice(
      "--preset", options.preset,
      Choices<Preset>{{"default", Preset::kDefault}, {"paper", Preset::kPaper}, {"tiny", Preset::kTiny}},
      "paper: the settings of Lu & Song (2015); docs/maths.md has the differences. tiny: as in half a "
      "MiB, with the last keyframe alone as a reference; docs/memory.md");
  group.choice("--features", options.features,
               Choices<Features>{
                   {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}},
               "What the motion is estimated from (default both)");
  group.choice("--reference", options.reference,
               Choices<ReferencePolicy>{{"previous", ReferencePolicy::kPreviousFrame},
                                        {"keyframe", ReferencePolicy::kKeyframe},
                                        {"both", ReferencePolicy::kKeyframeAndPrevious}},
               "What a frame is matched against: the frame before it, the last keyframe, or both (default)");
  group.number("--frame-budget", options.budget_ms, positive(1e6), "MS",
               "Fewer features after a frame that took more processor time than this, and more again when "
               "there is time to spare; results then depend on the machine");
  group.whole("--ransac-seed", options.seed, 0, UINT64_MAX, "Seed of RANSAC's random generator");
}

Config make_config(const OdometryOptions& options) {
  Config config;
  if (options.preset == Preset::kPaper) config = Config::paper();
  if (options.preset == Preset::kTiny) config = Config::tiny();
  config.features = options.features.value_or(config.features);
  config.references.policy = options.reference.value_or(config.references.policy);
  config.seed = options.seed.value_or(config.seed);
  config.budget.frame_ns = static_cast<std::int64_t>(options.budget_ms * 1e6);
  return config;
}

Limits make_limits(const OdometryOptions& options, const CameraModel& camera) {
  Limits limits = options.preset == Preset::kTiny ? Limits::tiny() : Limits();
  limits.width = camera.width;
  limits.height = camera.height;
  return limits;
}

Status OdometryBlock::init(const CameraModel& camera, const Config& config, const Limits& limits) {
  memory_.assign(required_bytes(limits) + kArenaAlignment, std::byte{0});
  return odometry_.init(memory_, camera, config, limits);
}

}  // namespace plvo::cli
