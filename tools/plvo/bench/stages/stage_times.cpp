// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/stage_times.hpp"

#include "plvo/base/random.hpp"
#include "plvo/bench/stages/track_counted.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo::bench {
namespace {

Status open(const NamedFolder& sequence, const JobOptions& options, RecordedCamera& camera) {
  const std::string& model = sequence.camera_model.empty() ? options.camera_model : sequence.camera_model;
  Calibration calibration;
  std::string guess;
  if (Status status = model.empty() ? sequence_calibration(sequence.folder, calibration, guess)
                                    : builtin_calibration(model, calibration);
      !status.ok())
    return status;
  SequenceOptions range;
  if (options.frames > 0) range.end_frame = options.frames;
  return camera.open(sequence.folder, calibration, range);
}

// Fills a new image for each frame, as the worst sensor would deliver it; stripes and squares move with the
// frame index.
void fill(Replacement replacement, int index, int width, int height, std::vector<std::uint8_t>& grey) {
  grey.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  Random random(static_cast<std::uint64_t>(index) + 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool stripe = ((x + index) / 8) % 2 != 0;
      const bool square = stripe != ((y / 8) % 2 != 0);
      std::uint8_t& pixel =
          grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
      switch (replacement) {
        case Replacement::kRecorded: break;
        case Replacement::kNoise: pixel = static_cast<std::uint8_t>(random.below(256)); break;
        case Replacement::kStripes: pixel = stripe ? 200 : 50; break;
        case Replacement::kCheckerboard: pixel = square ? 200 : 50; break;
      }
    }
  }
}

}  // namespace

Status measure_stages(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                      StageTimes& times) {
  RecordedCamera camera;
  if (Status status = open(sequence, options, camera); !status.ok()) return status;
  Limits limits = setting.tiny ? Limits::tiny() : Limits();
  limits.width = camera.model().width;
  limits.height = camera.model().height;
  limits.keypoints = setting.keypoints;
  limits.segments = setting.segments;
  limits.surfaces = setting.surfaces;
  if (Status status = limits.validate(); !status.ok()) return status;
  Config config = setting.tiny ? Config::tiny() : Config();
  config.stage_clock = posix_thread_cpu_ns;
  std::vector<std::byte> memory(required_bytes(limits) + kArenaAlignment);
  Odometry odometry;
  if (Status status = odometry.init(memory, camera.model(), config, limits); !status.ok()) return status;
  std::vector<std::uint8_t> replaced;
  int index = 0;
  for (RgbdFrame frame;; ++index) {
    const Status status = camera.next(frame);
    if (status.code() == StatusCode::kEndOfStream) return {};
    if (status.code() == StatusCode::kDamaged) continue;
    if (!status.ok()) return status;
    if (setting.replacement != Replacement::kRecorded) {
      fill(setting.replacement, index, limits.width, limits.height, replaced);
      frame.colour = {replaced.data(), limits.width, limits.height, limits.width, PixelFormat::kGray8};
    }
    if (index == 0) {
      (void)odometry.track(frame);
      continue;
    }
    const std::int64_t start = posix_thread_cpu_ns();
    const TrackResult result = track_counted(odometry, frame);
    times.frame_ms.push_back(static_cast<double>(posix_thread_cpu_ns() - start) * 1e-6);
    for (std::size_t stage = 0; stage < kStageCount; ++stage)
      times.stage_ms[stage].push_back(static_cast<double>(result.stage_ns[stage]) * 1e-6);
    times.points.push_back(result.points.with_depth);
    times.segments.push_back(result.lines.detected - result.lines.dropped);
    times.lost += result.state == TrackState::kLost ? 1 : 0;
  }
}

}  // namespace plvo::bench
