// SPDX-License-Identifier: Apache-2.0
// Tracks the procedural sequence with the settings of boards. A system call that no kernel has marks the
// beginning and the end of every frame for count_instructions.c.
#include <unistd.h>

#include <cstdio>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace {

using namespace plvo;

constexpr int kFrames = 12;
constexpr long kMark = 0x7ff0;

// Says its name, and marks all frames but the first, which has no motion.
bool track(const char* name, int width, int height, const Limits& limits, const Config& config) {
  std::puts(name);
  std::vector<std::byte> memory(required_bytes(limits));
  ProceduralSequence sequence(width, height);
  static Odometry odometry;
  if (!odometry.init(memory, sequence.camera(), config, limits).ok()) return false;
  (void)odometry.track(sequence.render(0));
  for (int i = 1; i < kFrames; ++i) {
    const RgbdFrame frame = sequence.render(i);
    syscall(kMark);
    const TrackResult result = odometry.track(frame);
    syscall(kMark);
    if (result.state != TrackState::kTracking) return false;
  }
  return true;
}

}  // namespace

int main() {
  return track("640×480", 640, 480, Limits::vga(), {}) && track("320×240", 320, 240, Limits::qvga(), {}) &&
                 track("320×240, tiny", 320, 240, Limits::tiny(), Config::tiny())
             ? 0
             : 1;
}
