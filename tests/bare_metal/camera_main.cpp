// SPDX-License-Identifier: Apache-2.0
// The example of a board's own camera at work: frames that a made-up DMA engine writes into padded rows give
// the same results as the same frames row by row; a sensor that stops is a time-out; of two frames the newer
// one counts. A watchdog is fed between the stages, and frames that took too long have fewer features.
#include <cstring>

#include "fingerprint.hpp"
#include "plvo/bare_metal/dma_camera.hpp"
#include "plvo/bare_metal/semihosting.hpp"
#include "plvo/bare_metal/systick_clock.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "text_line.hpp"

namespace {

using namespace plvo;
using namespace plvo::bare_metal;

constexpr int kWidth = 320, kHeight = 240, kColourStride = 1024, kDepthStride = 768;
constexpr std::uint32_t kProcessor_hz = 25'000'000;  // of the emulated board
constexpr Limits kLimits = Limits::qvga();
[[gnu::section(".plvo_arena")]] alignas(kArenaAlignment) std::byte arena[2][required_bytes(kLimits)];
[[gnu::section(".plvo_frames")]] alignas(
    kArenaAlignment) std::byte frames[ProceduralRenderer::required_bytes(kWidth, kHeight)];
struct alignas(32) Transfer {
  std::uint8_t colour[kHeight * kColourStride];
  std::uint16_t depth[kHeight * kDepthStride / 2];
};
[[gnu::section(".plvo_frames")]] Transfer transfers[DmaCamera::kBuffers];
Odometry odometry[2];
ProceduralRenderer sequence;
int invalidated = 0;

// What the engine does; the interrupt at its end is the caller's.
void transfer(const RgbdFrame& frame, const DmaBuffer& to) {
  for (int y = 0; y < kHeight; ++y) {
    std::memcpy(to.colour + y * kColourStride, frame.colour.data + y * frame.colour.stride_bytes, 3 * kWidth);
    std::memcpy(to.depth + y * kDepthStride / 2, frame.depth.data + y * frame.depth.stride, 2 * kWidth);
  }
}

std::uint64_t print_of(const TrackResult& result) {
  Fingerprint print;
  print.add(result.T_world_camera.t);
  print.add(result.T_world_camera.R);
  print.add(result.pose_covariance);
  print.add(result.points.inliers + result.lines.inliers);
  return print.value();
}

// A real one's register would be written here.
struct Watchdog {
  int fed = 0;
  static void feed(void* self, Stage) { ++static_cast<Watchdog*>(self)->fed; }
};

int fail(const char* what) {
  write_text(TextLine().text(what).text("\n").view());
  return 1;
}

}  // namespace

int main() {
  if (!sequence.init(kWidth, kHeight, frames)) return fail("too little memory");
  SystickClock clock(kProcessor_hz);
  const DmaLayout layout{PixelFormat::kRgb8, kColourStride, kDepthStride, 0.001};
  DmaCamera camera(sequence.camera(), layout,
                   {{{transfers[0].colour, transfers[0].depth},
                     {transfers[1].colour, transfers[1].depth},
                     {transfers[2].colour, transfers[2].depth}}},
                   clock, [](const void*, std::size_t) { ++invalidated; });
  Watchdog watchdog;
  Config config;
  config.stage_hook = {Watchdog::feed, &watchdog};
  config.budget.frame_ns = 1;  // every frame takes longer: down with each that is judged
  for (int k = 0; k < 2; ++k)
    if (!odometry[k].init(arena[k], camera.model(), config, kLimits).ok()) return fail("init");

  RgbdFrame frame;
  const std::int64_t start_ns = clock.monotonic_ns();
  if (camera.next(frame).code() != StatusCode::kTimeout)
    return fail("a sensor that stands still is a time-out");
  if (clock.monotonic_ns() - start_ns < 500'000'000) return fail("the time-out came early");
  for (int i = 0; i < 4; ++i) {
    if (i == 2) {  // a frame that the next one overtakes
      transfer(sequence.render_dark(i), camera.writing());
      camera.on_frame_complete(ProceduralRenderer::stamp_ns(i) - 1);
    }
    const RgbdFrame rendered = sequence.render(i);
    transfer(rendered, camera.writing());
    camera.on_frame_complete(rendered.stamp_ns);
    if (!camera.next(frame).ok()) return fail("the frame did not come");
    const TrackResult lent = odometry[0].track(frame), direct = odometry[1].track(rendered);
    if (lent.state != direct.state || print_of(lent) != print_of(direct)) return fail("the results differ");
    if (i > 0 && lent.state != TrackState::kTracking) return fail("the frames were not tracked");
    if (lent.feature_step != (i > 0 ? 1 : 0)) return fail("the budget was not kept");
    for (Odometry& one : odometry) one.frame_took(2);
  }
  // Image, points, lines; and at least twice matching and motion.
  if (watchdog.fed < 2 * (4 * 3 + 3 * 4)) return fail("the watchdog was not fed between the stages");
  if (invalidated != 8) return fail("the cache was not told of every image");
  write_text("the camera's frames and the renderer's give the same results\n");
  return 0;
}
