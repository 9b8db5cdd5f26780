// SPDX-License-Identifier: Apache-2.0
// How many instructions a frame takes: for an emulator whose clock gains a nanosecond with each of them.
#include <algorithm>
#include <array>

#include "plvo/bare_metal/semihosting.hpp"
#include "plvo/bare_metal/systick_clock.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"
#include "text_line.hpp"

namespace {

using namespace plvo;

constexpr std::uint32_t kBoardHz = 25'000'000;
constexpr int kFrames = 16;

[[gnu::section(".plvo_arena")]] alignas(kArenaAlignment) std::byte arena[required_bytes(Limits::qvga())];
[[gnu::section(".plvo_frames")]] alignas(
    kArenaAlignment) std::byte frames[ProceduralRenderer::required_bytes(320, 240)];
Odometry odometry;
ProceduralRenderer sequence;
TrackResult result;

// The median over the frames that have one before them; 0 when one is lost.
std::int64_t instructions_a_frame(const Limits& limits, const Config& config, const Clock& clock) {
  if (!odometry.init(arena, sequence.camera(), config, limits).ok()) return 0;
  std::array<std::int64_t, kFrames> taken{};
  for (int i = 0; i < kFrames; ++i) {
    const RgbdFrame frame = sequence.render(i);
    const std::int64_t before = clock.monotonic_ns();
    result = odometry.track(frame);
    taken[static_cast<std::size_t>(i)] = clock.monotonic_ns() - before;
    if (i > 0 && result.state != TrackState::kTracking) return 0;
  }
  std::sort(taken.begin() + 1, taken.end());
  return taken[1 + (kFrames - 1) / 2];
}

}  // namespace

int main() {
  const bare_metal::SystickClock clock(kBoardHz);
  if (!sequence.init(320, 240, frames)) return 1;
  const std::int64_t qvga = instructions_a_frame(Limits::qvga(), {}, clock);
  const std::int64_t tiny = instructions_a_frame(Limits::tiny(), Config::tiny(), clock);
  bare_metal::write_text(
      TextLine().text("320×240 ").integer(qvga).text("\n320×240, tiny ").integer(tiny).text("\n").view());
  return qvga > 0 && tiny > 0 ? 0 : 1;
}
