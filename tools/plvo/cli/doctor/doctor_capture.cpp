// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/doctor/doctor_capture.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plvo/cli/common/interrupt.hpp"
#include "plvo/host/posix_clock.hpp"

namespace plvo::cli {
namespace {

constexpr double kDark = 12;           // mean brightness below which nothing can be found in an image
constexpr double kFewDepth = 0.05;     // share of pixels with depth
constexpr double kGoodRate = 0.9;      // of what was asked for
constexpr double kFirstFrame_s = 5.0;  // a sensor may take its time to start

struct WarningList final : Log {
  void write(LogLevel level, std::string_view message) override {
    if (level != LogLevel::kInfo) texts.emplace_back(message);
  }
  std::vector<std::string> texts;
};

double brightness(const ColourView& image) {
  const int row_bytes = image.width * (image.format == PixelFormat::kGray8 ? 1 : 3);
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.data + y * image.stride_bytes;
    for (int i = 0; i < row_bytes; ++i) sum += row[i];
  }
  return sum / (static_cast<double>(row_bytes) * image.height);
}

double depth_share(const DepthView& image) {
  std::int64_t seen = 0;
  for (int y = 0; y < image.height; ++y) {
    const std::uint16_t* row = image.data + y * image.stride;
    seen += std::count_if(row, row + image.width, [](std::uint16_t depth) { return depth != 0; });
  }
  return static_cast<double>(seen) / (static_cast<double>(image.width) * image.height);
}

}  // namespace

double CaptureFacts::megabytes_per_s() const {
  return hz() * static_cast<double>(mode.width) * mode.height * 5 * 1e-6;  // RGB and 16 bits of depth
}

CaptureFacts capture(const LiveCameraOptions& options, double seconds) {
  CaptureFacts facts;
  facts.tried = true;
  WarningList log;
  std::unique_ptr<LiveCamera> camera;
  facts.opened = open_live_camera(options, log, camera);
  if (!facts.opened.ok()) return facts;
  facts.name = camera->name();
  facts.registered_by_device = camera->registered_by_device();
  facts.depth_time_known = camera->model().depth_timing.known;
  facts.mode.width = camera->model().width;
  facts.mode.height = camera->model().height;
  if (VideoMode asked; parse_video_mode(options.mode, asked)) facts.mode.fps = asked.fps;

  const auto now = [] { return static_cast<double>(posix_monotonic_ns()) * 1e-9; };
  RgbdFrame frame;
  const double opened_at = now();
  do {
    facts.last = camera->next(frame);
  } while (!facts.last.ok() && now() - opened_at < kFirstFrame_s && !interrupted());
  const OpenNi2Counters before = camera->counters();
  double start = now(), last_frame = start;
  while (facts.last.code() != StatusCode::kEndOfStream && last_frame - start < seconds &&
         now() - start < seconds + 2 && before.frames > 0 && !interrupted()) {
    facts.last = camera->next(frame);
    if (!facts.last.ok()) continue;
    last_frame = now();
    facts.mean_brightness = brightness(frame.colour);
    facts.depth_share = depth_share(frame.depth);
  }
  facts.seconds = std::max(last_frame, std::min(now(), start + seconds)) - start;
  facts.counters = camera->counters();
  facts.counters.frames -= before.frames;
  facts.warnings = log.texts;
  return facts;
}

std::vector<CaptureFinding> judge(const CaptureFacts& facts) {
  std::vector<CaptureFinding> out;
  const auto problem = [&](const char* code, std::string what, std::string remedy) {
    out.push_back({Severity::kProblem, code, std::move(what), std::move(remedy)});
  };
  if (!facts.tried) return out;
  if (!facts.opened.ok()) {
    problem("not_opened", fmt::format("The test capture could not start: {}.", facts.opened.message()), "");
    return out;
  }
  if (facts.counters.frames == 0) {
    problem("no_frames",
            fmt::format("{} was opened, but no pair of colour and depth came: {}.", facts.name,
                        facts.last.message()),
            "Unplug the sensor and plug it in again (a Kinect's 12 V supply too), use a port of the computer "
            "itself, and "
            "try again.");
    return out;
  }
  if (facts.hz() < kGoodRate * facts.mode.fps) {
    problem(
        "slow", fmt::format("Only {:.1f} of {} frames came per second.", facts.hz(), facts.mode.fps),
        "Close other programs, use a USB port of the computer itself that no other busy device shares, or "
        "a smaller --mode.");
  }
  if (facts.mean_brightness < kDark) {
    problem("dark",
            fmt::format("The colour image is black (mean brightness {:.0f} of 255).", facts.mean_brightness),
            "Take the cover off, or switch a light on: no features can be found in the dark.");
  }
  if (facts.depth_share < kFewDepth) {
    problem("no_depth", fmt::format("Only {:.0f} % of the pixels have depth.", 100 * facts.depth_share),
            "Uncover the infrared projector, keep 0.5 to 4 m of distance, and stay out of direct sunlight.");
  }
  if (!out.empty()) return out;
  out.push_back({Severity::kGood, "capture_good", "The test capture is good: plvo live will work.", ""});
  if (!facts.depth_time_known) {
    out.push_back(
        {Severity::kNote, "depth_time_unknown",
         "When this sensor exposes depth is not known; it is taken as exposed with colour.",
         "plvo record turns --seconds 30, turning the camera to and fro by hand; then plvo calibrate turns "
         "--out camera.yaml, and --calibration camera.yaml from then on."});
  }
  return out;
}

}  // namespace plvo::cli
