// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/odometry_options.hpp"

#include <map>
#include <string>

namespace plvo::cli {

void add_odometry_options(CLI::App& command, OdometryOptions& options) {
  const std::map<std::string, Preset> presets = {{"default", Preset::kDefault}, {"paper", Preset::kPaper}};
  const std::map<std::string, Features> features = {
      {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}};
  const std::map<std::string, ReferencePolicy> references = {{"previous", ReferencePolicy::kPreviousFrame},
                                                             {"keyframe", ReferencePolicy::kKeyframe},
                                                             {"both", ReferencePolicy::kKeyframeAndPrevious}};
  const std::string group = "Odometry";
  command.add_option("--preset", options.preset, "default, or paper: the settings of Lu & Song (2015)")
      ->transform(CLI::CheckedTransformer(presets).description(""))
      ->type_name("NAME")
      ->group(group);
  command.add_option("--features", options.features, "points, lines or both")
      ->transform(CLI::CheckedTransformer(features).description(""))
      ->type_name("KIND")
      ->group(group);
  CLI::Option* reference = command
                               .add_option("--reference", options.reference,
                                           "Match against the previous frame, the last keyframe, or both")
                               ->transform(CLI::CheckedTransformer(references).description(""))
                               ->type_name("previous|keyframe|both")
                               ->group(group);
  command
      .add_flag_callback(
          "--keyframes", [&options] { options.reference = ReferencePolicy::kKeyframe; },
          "Short for --reference keyframe")
      ->excludes(reference)
      ->group(group);
  command.add_option("--ransac-seed", options.seed, "Seed of RANSAC's random generator")
      ->type_name("NUMBER")
      ->group(group);
}

Config make_config(const OdometryOptions& options) {
  Config config = options.preset == Preset::kPaper ? Config::paper() : Config();
  config.features = options.features.value_or(config.features);
  config.references.policy = options.reference.value_or(config.references.policy);
  config.seed = options.seed.value_or(config.seed);
  return config;
}

Status OdometryBlock::init(const CameraModel& camera, const Config& config) {
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  memory_.assign(required_bytes(limits) + kArenaAlignment, std::byte{0});
  return odometry_.init(memory_, camera, config, limits);
}

}  // namespace plvo::cli
