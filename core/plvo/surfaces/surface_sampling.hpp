// SPDX-License-Identifier: Apache-2.0
// Chooses a frame's samples of its surfaces. Of a grid over the image, where there is a plane; when these are
// more than there is room for, as many from each direction that surfaces face as from any other, as far as
// there are (normal-space sampling: Rusinkiewicz & Levoy, "Efficient variants of the ICP algorithm", 2001):
// a small piece of floor holds what a large wall leaves open.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/base/arena.hpp"
#include "plvo/surfaces/plane_window.hpp"

namespace plvo {

// Of the whole image, width × height. Scratch: see below.
void sample_surfaces(const DepthSampler& depth, const Pinhole& pinhole, int width, int height,
                     double noise_scale, Arena& scratch, SurfaceFeatures& features);

inline constexpr int kSurfaceCell = 24;  // px

constexpr void reserve_surface_sampling(Arena& memory, int width, int height, int samples) {
  if (samples == 0) return;
  const ScratchScope scope(memory);
  const auto cells = static_cast<std::size_t>((width / kSurfaceCell + 1) * (height / kSurfaceCell + 1));
  memory.take<SurfaceSample>("surface candidates", cells);
  memory.take<std::uint16_t>("turns of surface candidates", cells);
}

}  // namespace plvo
