// SPDX-License-Identifier: Apache-2.0
// Procedural textures: the colour of a point of a face. Every pattern is averaged over the footprint of the
// pixel on the surface (edges by box filtering, noise by omitting the octaves that the pixel cannot resolve).
// Images therefore neither flicker nor contain aliases that a sub-pixel tracker would follow.
#pragma once

#include <cstdint>

#include "plvo/simulator/float3.hpp"

namespace plvo::sim {

enum class Pattern : std::uint8_t {
  kPlain,
  kPlaster,     // faint mottling and a few scuff marks
  kWood,        // grain along the longer side of the face
  kLinoleum,    // speckles and scratches
  kTiles,       // square tiles of edge `scale`, grout in `second`
  kBricks,      // 24 × 7 cm, mortar in `second`
  kCarpet,      // coarse fabric
  kPoster,      // a picture, a headline and lines of text, laid out over the whole face
  kPaper,       // printed lines on white
  kSpine,       // a book's back: bands and a title
  kScreen,      // a monitor that shows windows and text; emits
  kKeyboard,    // rows of keys
  kWhiteboard,  // a few pen strokes
  kGrid,        // bars of width 12 % of `scale` in `second` (ceiling panels, grilles)
  kWindow,      // sky above trees behind panes; emits
  kLampPanel,   // emits evenly
};

struct Material {
  Pattern pattern = Pattern::kPlain;
  Rgb base{0.5F, 0.5F, 0.5F};
  Rgb second{0.2F, 0.2F, 0.2F};
  float scale = 0.3F;     // m, period of the pattern, if it has one
  float contrast = 1;     // amplitude factor of the noise
  float gloss = 0;        // 0 matt … 1 polished
  float mirror = 0;       // share of the light that is reflected as by a mirror, at any angle
  float infrared = 0.6F;  // share of the projector's light that is reflected diffusely
  float emission = 0;     // radiance where the pattern emits
};

// A point on a face and the footprint of the pixel there.
struct SurfaceSample {
  float u = 0, v = 0;              // m from the face's corner
  float width_u = 0, width_v = 0;  // m, footprint of the pixel
  float size_u = 1, size_v = 1;    // m, of the face
  std::uint32_t seed = 0;
};

// Returns the diffuse reflectance at the sample; `emitted` receives the radiance that the surface emits.
Rgb shade_material(const Material& material, const SurfaceSample& at, Rgb& emitted);

}  // namespace plvo::sim
