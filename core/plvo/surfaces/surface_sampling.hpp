// SPDX-License-Identifier: Apache-2.0
// Selects the surface samples of a frame. Candidates are the positions of a grid over the image where there
// is a plane. If there are more candidates than capacity, the selection takes equal numbers from all
// directions of the normal, as far as available (normal-space sampling: Rusinkiewicz & Levoy, "Efficient
// variants of the ICP algorithm", 2001). A small patch of floor constrains what a large wall leaves open.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plvo/base/arena.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/surfaces/plane_window.hpp"

namespace plvo {

// Samples the whole image, width × height, and fills features up to its capacity. Scratch: see
// reserve_surface_sampling.
void sample_surfaces(const DepthSampler& depth, const Pinhole& pinhole, int width, int height,
                     double noise_scale, Arena& scratch, SurfaceFeatures& features,
                     const ImageMask& mask = {});

inline constexpr int kSurfaceCell = 24;  // px

constexpr void reserve_surface_sampling(Arena& memory, int width, int height, int samples) {
  if (samples == 0) return;
  const ScratchScope scope(memory);
  const auto cells = static_cast<std::size_t>((width / kSurfaceCell + 1) * (height / kSurfaceCell + 1));
  memory.take<SurfaceSample>("surface candidates", cells);
  memory.take<std::uint16_t>("turns of surface candidates", cells);
}

}  // namespace plvo
