// SPDX-License-Identifier: Apache-2.0
// The golden run of a small map, whose output (map_golden.txt) must be the same bytes everywhere: a camera
// moves to and fro in the procedural room, is covered, and is found again; places are recognised and
// keyframes make room. At the end the map is saved, and loaded. Without an operating system.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "plvo/map/map.hpp"
#include "procedural_sequence.hpp"

namespace plvo {

inline constexpr Limits kMapGoldenLimits = {160, 120, 250, 64, 2, 1, 0};
inline constexpr MapLimits kMapGoldenMapLimits = {10, 200, 64};

// What map_golden_run needs: the blocks of the odometry, of the map and of the renderer, and room for the
// saved map.
inline constexpr std::size_t kMapGoldenArenaBytes = required_bytes(kMapGoldenLimits);
inline constexpr std::size_t kMapGoldenMapBytes =
    Map::required_bytes(kMapGoldenMapLimits, kMapGoldenLimits.width, kMapGoldenLimits.height);
inline constexpr std::size_t kMapGoldenFrameBytes =
    ProceduralRenderer::required_bytes(kMapGoldenLimits.width, kMapGoldenLimits.height);
inline constexpr std::size_t kMapGoldenFileBytes = 320 * 1024;

struct MapGoldenMemory {
  std::span<std::byte> arena, map_arena, frames, file;
  Odometry& odometry;
  Map& map;
};

// Hands every line, without its end, to `print`. False, after a line that says why, when the run fails.
bool map_golden_run(const MapGoldenMemory& memory, void (*print)(std::string_view line));

}  // namespace plvo
