// SPDX-License-Identifier: Apache-2.0
// The run whose output must be the same bytes from every compiler, level and processor: golden.txt holds it.
// A line a frame, with the state, the position, a fingerprint of what each stage left behind, and one over
// every number of the result. Without an operating system: the caller brings the memory and takes the lines.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {

// What golden_run needs: the odometry's block, and the renderer's.
inline constexpr std::size_t kGoldenArenaBytes = required_bytes(Limits::vga());
inline constexpr std::size_t kGoldenFrameBytes = ProceduralRenderer::required_bytes(640, 480);

struct GoldenMemory {
  std::span<std::byte> arena, frames;
  Odometry& odometry;
};

// Hands every line, without its end, to `print`. False, after a line that says why, when a run cannot start.
bool golden_run(const GoldenMemory& memory, void (*print)(std::string_view line));

}  // namespace plvo
