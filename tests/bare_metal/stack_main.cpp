// SPDX-License-Identifier: Apache-2.0
// How much stack the odometry was seen to use: painted before each call of track(), over frames that are
// found, lost, looked for widely, and found again.
#include <algorithm>

#include "plvo/bare_metal/semihosting.hpp"
#include "plvo/bare_metal/stack_paint.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "text_line.hpp"

namespace {

using namespace plvo;

constexpr Limits kLimits = Limits::qvga();
[[gnu::section(".plvo_arena")]] alignas(kArenaAlignment) std::byte arena[required_bytes(kLimits)];
[[gnu::section(".plvo_frames")]] alignas(
    kArenaAlignment) std::byte frames[ProceduralRenderer::required_bytes(320, 240)];
Odometry odometry;
ProceduralRenderer sequence;
TrackResult result;

// Bytes that the call took below the frame of the function that makes it: `call` notes where that is. What
// the call returns lies in that frame, the caller's.
std::size_t before = 0;

template <typename Call>
std::size_t stack_of(Call call) {
  bare_metal::paint_stack();
  call();
  const std::size_t deepest = bare_metal::deepest_stack_bytes();
  return deepest > before ? deepest - before : 0;
}

[[gnu::noinline]] void track(const RgbdFrame& frame) {
  before = bare_metal::current_stack_bytes();
  result = odometry.track(frame);
}

[[gnu::noinline]] bool init(const CameraModel& camera, const Config& config) {
  before = bare_metal::current_stack_bytes();
  return odometry.init(arena, camera, config, kLimits).ok();
}

}  // namespace

int main() {
  if (!sequence.init(320, 240, frames)) return 1;
  bool ready = false;
  Config config;
  config.references.max_lost_s = 0.03;
  CameraModel camera = sequence.camera();
  camera.readout_s = 0.0261;  // a rolling shutter's corrections too
  const std::size_t init_bytes = stack_of([&] { ready = init(camera, config); });
  if (!ready) return 1;
  std::size_t track_bytes = 0;
  for (int i = 0; i < 10; ++i) {
    // 3 is lost; 4 jumps, so that the first search fails; 6 and 7 end the reference, 8 starts anew.
    const bool dark = i == 3 || i == 6 || i == 7;
    RgbdFrame frame = dark ? sequence.render_dark(i) : sequence.render(i == 4 ? 7 : i);
    frame.stamp_ns = sequence.stamp_ns(i);
    track_bytes = std::max(track_bytes, stack_of([&] { track(frame); }));
  }
  bare_metal::write_text(TextLine()
                             .text("init ")
                             .integer(static_cast<std::int64_t>(init_bytes))
                             .text(" track ")
                             .integer(static_cast<std::int64_t>(track_bytes))
                             .text("\n")
                             .view());
  return result.state == TrackState::kTracking ? 0 : 1;
}
