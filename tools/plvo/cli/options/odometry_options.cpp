// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/odometry_options.hpp"

#include <algorithm>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/replay/images/mask_file.hpp"

namespace plvo::cli {

void add_odometry_options(CLI::App& command, OdometryOptions& options) {
  OptionGroup group(command, "Odometry");
  group.choice(
      "--preset", options.preset,
      Choices<Preset>{{"default", Preset::kDefault}, {"paper", Preset::kPaper}, {"tiny", Preset::kTiny}},
      "paper: the settings of Lu & Song (2015); the differences are in share/doc/plvo/theory/estimator.md. "
      "tiny: as in half a MiB, with the last keyframe alone as a reference; "
      "share/doc/plvo/user/small_board.md");
  group.choice("--features", options.features,
               Choices<Features>{
                   {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}},
               "What the motion is estimated from (default both)");
  group.choice(
      "--reference", options.reference,
      Choices<ReferencePolicy>{{"previous", ReferencePolicy::kPreviousFrame},
                               {"keyframe", ReferencePolicy::kKeyframe},
                               {"both", ReferencePolicy::kKeyframeAndPrevious},
                               {"window", ReferencePolicy::kWindow}},
      "What a frame is matched against: the frame before it, the last keyframe, both: the keyframe and "
      "a recent frame (default), or window: both and the keyframe before, which drifts less where the "
      "camera travels and takes more time and memory; share/doc/plvo/decisions/window.md");
  group.number("--frame-budget", options.budget_ms, positive(1e6), "MS",
               "Fewer features after a frame that took more processor time than this, and more again when "
               "there is time to spare; results then depend on the machine");
  group.whole("--cores", options.cores, 1, 2,
              "2: points and lines are searched for at the same time, and images and features halved between "
              "two threads; results are the same. Times of stages are those of the first (default 1)");
  group.whole("--surfaces", options.surfaces, 0, 1000,
              "Number of samples of surfaces from each depth image, besides points and lines; 0: none "
              "(default 200; none of --preset paper and tiny)");
  group.path("--mask", options.mask,
             "PNG of the size of the colour images, drawn over one of them: white is used, black is not. For "
             "what travels with the camera: a part of the robot in view, burnt-in text");
  group.whole("--ransac-seed", options.seed, 0, UINT64_MAX, "Seed of RANSAC's random generators");
}

void check_odometry_options(const OdometryOptions& options) {
  if (options.preset == Preset::kPaper && options.surfaces.value_or(0) > 0)
    refuse("--surfaces",
           "does not apply to --preset paper, which matches a frame once: surfaces are looked for "
           "where a first estimate of the motion puts them");
  if (options.preset == Preset::kTiny && options.reference &&
      references_of(*options.reference) > Limits::tiny().references)
    refuse(
        "--reference",
        "both and window do not apply to --preset tiny, whose memory holds one reference: give keyframe or "
        "previous");
}

namespace {

// The preset, then what was asked for beside it.
Config make_config(const OdometryOptions& options) {
  Config config;
  if (options.preset == Preset::kPaper) config = Config::paper();
  if (options.preset == Preset::kTiny) config = Config::tiny();
  config.features = options.features.value_or(config.features);
  config.surfaces = options.surfaces ? *options.surfaces > 0 : config.surfaces;
  config.references.policy = options.reference.value_or(config.references.policy);
  config.seed = options.seed.value_or(config.seed);
  config.level_world = options.level_world;
  config.budget.frame_ns = static_cast<std::int64_t>(options.budget_ms * 1e6);
  return config;
}

Limits make_limits(const OdometryOptions& options, const Config& config, const CameraModel& camera) {
  Limits limits = options.preset == Preset::kTiny ? Limits::tiny() : Limits();
  limits.width = camera.width;
  limits.height = camera.height;
  limits.references = std::max(limits.references, references_of(config.references.policy));
  limits.cores = options.cores;
  limits.surfaces = options.surfaces.value_or(limits.surfaces);
  return limits;
}

}  // namespace

Status OdometryBlock::init(const CameraModel& camera, const OdometryOptions& options, int scaled_down_by) {
  Config config = make_config(options);
  config.stage_clock = posix_thread_cpu_ns;
  if (options.cores > 1) {
    pair_ = std::make_unique<ThreadPair>();
    config.executor = pair_->executor();
  }
  Limits limits = make_limits(options, config, camera);
  if (!options.mask.empty()) {
    if (Status status = read_mask(options.mask, camera.width, camera.height, scaled_down_by, used_pixels_);
        !status.ok())
      return status;
    config.mask = {used_pixels_.data(), camera.width, camera.height, camera.width};
    limits.mask = true;
  }
  config_ = config;
  memory_.assign(required_bytes(limits) + kArenaAlignment, std::byte{0});
  return odometry_.init(memory_, camera, config, limits);
}

std::int64_t OdometryBlock::cpu_ns() const {
  return posix_thread_cpu_ns() + (pair_ != nullptr ? pair_->cpu_ns() : 0);
}

void OdometryBlock::track(const RgbdFrame& frame, ImuIntegrator* imu, const MotionPrior& wheels,
                          FrameRecord& record) {
  const std::int64_t start_ns = posix_monotonic_ns();
  const std::int64_t cpu_before_ns = cpu_ns();
  record.result = imu != nullptr ? odometry_.track(frame, *imu, wheels) : odometry_.track(frame, wheels);
  record.cpu_ns = cpu_ns() - cpu_before_ns;
  record.elapsed_ns = posix_monotonic_ns() - start_ns;
  odometry_.frame_took(record.cpu_ns);
}

}  // namespace plvo::cli
