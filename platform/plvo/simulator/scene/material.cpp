// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/material.hpp"

#include <algorithm>

#include "plvo/simulator/hash.hpp"

namespace plvo::sim {
namespace {

float floor_to(float x) {
  const auto truncated = static_cast<float>(static_cast<int>(x));
  return truncated > x ? truncated - 1 : truncated;
}

// Share of [x − width/2, x + width/2] that lies in [lo, hi].
float covered(float x, float width, float lo, float hi) {
  width = std::max(width, 1e-6F);
  return clamp01((x - lo) / width + 0.5F) - clamp01((x - hi) / width + 0.5F);
}

// The same for an infinite row of bars [0, duty·period) + k·period.
float covered_bars(float x, float width, float period, float duty) {
  width = std::max(width, 1e-6F);
  // Integral of the bar function from 0 to x.
  const auto integral = [&](float y) {
    const float k = floor_to(y / period);
    return k * duty * period + std::min(y - k * period, duty * period);
  };
  return (integral(x + width * 0.5F) - integral(x - width * 0.5F)) / width;
}

// Fractal noise: octaves of wavelength `wave`, wave/2, …, of equal amplitude. Each fades out as its
// wavelength falls below three pixels. The range is about ±octaves·0.6.
float noise(const SurfaceSample& s, float wave_u, float wave_v, int octaves, std::uint32_t seed) {
  float sum = 0;
  for (int k = 0; k < octaves; ++k) {
    const float finest = std::min(wave_u / std::max(s.width_u, 1e-6F), wave_v / std::max(s.width_v, 1e-6F));
    const float weight = clamp01((finest - 1.5F) * 0.5F);
    if (weight <= 0) break;
    sum += weight * value_noise(s.u / wave_u, s.v / wave_v, hash(seed + static_cast<std::uint32_t>(k)));
    wave_u *= 0.5F;
    wave_v *= 0.5F;
  }
  return sum;
}

// Sparse marks: one cell in `1/probability` contains a small rectangle. Returns its coverage.
float marks(const SurfaceSample& s, float cell, float probability, float size, std::uint32_t seed) {
  const float cu = floor_to(s.u / cell);
  const float cv = floor_to(s.v / cell);
  const std::uint32_t h = hash(static_cast<std::uint32_t>(static_cast<int>(cu)),
                               static_cast<std::uint32_t>(static_cast<int>(cv)), seed);
  if (uniform(h) >= probability) return 0;
  const std::uint32_t h2 = hash(h);
  const std::uint32_t h3 = hash(h2);
  const float long_side = size * (0.4F + uniform(hash(h3)));
  const float short_side = size * (0.15F + 0.35F * uniform(hash(h3 + 1)));
  const bool upright = (h3 & 1) != 0;
  const float half_u = 0.5F * (upright ? short_side : long_side);
  const float half_v = 0.5F * (upright ? long_side : short_side);
  const float u = cu * cell + half_u + uniform(h2) * (cell - 2 * half_u);
  const float v = cv * cell + half_v + uniform(h3) * (cell - 2 * half_v);
  return covered(s.u, s.width_u, u - half_u, u + half_u) * covered(s.v, s.width_v, v - half_v, v + half_v);
}

// `lines` lines of words in the rectangle [u0, u1] × [v0, v1] (as shares of the face). Returns the ink
// coverage.
float text(const SurfaceSample& s, float u0, float u1, float v0, float v1, int lines, std::uint32_t seed) {
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float width_u = s.width_u / s.size_u;
  const float width_v = s.width_v / s.size_v;
  if (u < u0 - width_u || u > u1 + width_u || v < v0 - width_v || v > v1 + width_v) return 0;
  const float inside = covered(u, width_u, u0, u1) * covered(v, width_v, v0, v1);
  const float pitch = (v1 - v0) / static_cast<float>(lines);
  const float ink_rows = covered_bars(v - v0, width_v, pitch, 0.45F);
  // Words: each cell of four glyph widths along the line is inked or not; glyphs are bars inside it.
  const float glyph = 0.5F * pitch * s.size_v / s.size_u;
  const auto line = static_cast<std::uint32_t>(static_cast<int>(floor_to((v - v0) / pitch)));
  const auto word = static_cast<std::uint32_t>(static_cast<int>(floor_to((u - u0) / (4 * glyph))));
  const float resolved = clamp01(4 * glyph / std::max(width_u, 1e-6F) - 1);
  const float written = mix(0.75F, uniform(hash(word, line, seed)) < 0.75F ? 1.0F : 0.0F, resolved);
  const float letters = covered_bars(u - u0 + uniform(hash(line, seed)) * glyph, width_u, glyph, 0.6F);
  return inside * ink_rows * written * letters;
}

Rgb tint(std::uint32_t h, float lo, float hi) {
  return {mix(lo, hi, uniform(h)), mix(lo, hi, uniform(hash(h + 1))), mix(lo, hi, uniform(hash(h + 2)))};
}

// The grain runs along the longer side of the face.
Rgb wood(const Material& m, const SurfaceSample& s) {
  const bool along_v = s.size_v >= s.size_u;
  const float thin = 0.012F;
  const float grain = along_v ? noise(s, thin, thin * 25, 3, s.seed) : noise(s, thin * 25, thin, 3, s.seed);
  const float broad =
      along_v ? noise(s, 0.09F, 1.1F, 2, s.seed ^ 77U) : noise(s, 1.1F, 0.09F, 2, s.seed ^ 77U);
  return mix(m.base, m.second, clamp01(0.3F + m.contrast * (0.16F * grain + 0.2F * broad)));
}

Rgb tiles(const Material& m, const SurfaceSample& s, float pitch_u, float pitch_v, float joint,
          bool staggered) {
  const float row = floor_to(s.v / pitch_v);
  const bool odd = (static_cast<int>(row) & 1) != 0;
  const float u = staggered && odd ? s.u + 0.5F * pitch_u : s.u;
  const float body = covered_bars(u - 0.5F * joint, s.width_u, pitch_u, 1 - joint / pitch_u) *
                     covered_bars(s.v - 0.5F * joint, s.width_v, pitch_v, 1 - joint / pitch_v);
  const float fade = clamp01(
      std::min(pitch_u / std::max(s.width_u, 1e-6F), pitch_v / std::max(s.width_v, 1e-6F)) * 0.5F - 1);
  const std::uint32_t h = hash(static_cast<std::uint32_t>(static_cast<int>(floor_to(u / pitch_u))),
                               static_cast<std::uint32_t>(static_cast<int>(row)), s.seed);
  const float shade =
      1 + m.contrast * (0.12F * fade * signed_uniform(h) + 0.05F * noise(s, 0.06F, 0.06F, 4, s.seed));
  return mix(m.second, m.base * shade, body);
}

// A poster that fills the face: background, picture with coloured fields, headline, text.
Rgb poster(const Material& m, const SurfaceSample& s) {
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float width_u = s.width_u / s.size_u;
  const float width_v = s.width_v / s.size_v;
  const std::uint32_t h = hash(s.seed);
  const float split = 0.3F + 0.3F * uniform(h);  // text below, picture above
  Rgb colour = m.base;
  Rgb picture = mix(tint(hash(h + 11), 0.05F, 0.5F), tint(hash(h + 17), 0.1F, 0.7F),
                    clamp01((v - split) / (0.95F - split)));
  for (std::uint32_t k = 0; k < 9; ++k) {
    const std::uint32_t f = hash(h + 100 + 7 * k);
    const float fu = 0.06F + 0.6F * uniform(f);
    const float fv = split + (0.9F - split) * 0.8F * uniform(hash(f + 1));
    const float eu = 0.06F + 0.25F * uniform(hash(f + 2));
    const float ev = 0.03F + 0.2F * uniform(hash(f + 3));
    const float inside =
        covered(u, width_u, fu, std::min(fu + eu, 0.94F)) * covered(v, width_v, fv, std::min(fv + ev, 0.86F));
    if (inside > 0) picture = mix(picture, tint(hash(f + 4), 0.02F, 0.75F), inside);
  }
  picture = picture * std::max(0.1F, 1 + 0.25F * noise(s, 0.12F, 0.12F, 5, h));
  colour = mix(colour, picture, covered(u, width_u, 0.05F, 0.95F) * covered(v, width_v, split, 0.87F));
  const Rgb ink = m.second;
  colour = mix(colour, ink, 0.9F * text(s, 0.08F, 0.8F, 0.89F, 0.97F, 1, h + 5));
  colour = mix(colour, ink, 0.8F * text(s, 0.08F, 0.92F, 0.05F, split - 0.04F, 7, h + 6));
  return colour;
}

Rgb screen(const Material& m, const SurfaceSample& s, Rgb& emitted) {
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float width_u = s.width_u / s.size_u;
  const float width_v = s.width_v / s.size_v;
  const float lit = covered(u, width_u, 0.03F, 0.97F) * covered(v, width_v, 0.05F, 0.96F);
  const std::uint32_t h = hash(s.seed);
  Rgb shown = mix(Rgb{0.03F, 0.08F, 0.2F}, Rgb{0.1F, 0.3F, 0.4F}, v);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t f = hash(h + 31 * k);
    const float u0 = 0.06F + 0.4F * uniform(f);
    const float v0 = 0.08F + 0.3F * uniform(hash(f + 1));
    const float u1 = std::min(u0 + 0.3F + 0.3F * uniform(hash(f + 2)), 0.95F);
    const float v1 = std::min(v0 + 0.3F + 0.3F * uniform(hash(f + 3)), 0.93F);
    const float inside = covered(u, width_u, u0, u1) * covered(v, width_v, v0, v1);
    if (inside <= 0) continue;
    Rgb window = (f & 1) != 0 ? Rgb{0.85F, 0.85F, 0.85F} : Rgb{0.05F, 0.05F, 0.06F};
    const Rgb ink = (f & 1) != 0 ? Rgb{0.05F, 0.05F, 0.1F} : Rgb{0.3F, 0.8F, 0.4F};
    window = mix(window, ink, text(s, u0 + 0.02F, u1 - 0.04F, v0 + 0.03F, v1 - 0.08F, 12, f));
    window = mix(window, Rgb{0.25F, 0.35F, 0.6F}, covered(v, width_v, v1 - 0.04F, v1));
    shown = mix(shown, window, inside);
  }
  emitted = shown * (m.emission * lit);
  return m.base;
}

Rgb window(const Material& m, const SurfaceSample& s, Rgb& emitted) {
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float trees = 0.35F + 0.06F * noise(s, 0.5F, 0.5F, 4, s.seed);
  const float sky = clamp01((v - trees) * s.size_v / std::max(s.width_v, 0.02F) + 0.5F);
  const Rgb green = Rgb{0.07F, 0.11F, 0.04F} * std::max(0.2F, 1 + 0.5F * noise(s, 0.2F, 0.2F, 4, s.seed + 9));
  const Rgb outside = mix(green, mix(Rgb{0.9F, 0.95F, 1.0F}, Rgb{0.5F, 0.7F, 1.0F}, v), sky);
  const float panes =
      covered(u, s.width_u / s.size_u, 0.06F, 0.48F) + covered(u, s.width_u / s.size_u, 0.52F, 0.94F);
  const float lit = panes * covered(v, s.width_v / s.size_v, 0.06F, 0.94F);
  emitted = outside * (m.emission * lit);
  return m.base * (1 - 0.9F * lit);
}

Rgb whiteboard(const Material& m, const SurfaceSample& s) {
  float ink = text(s, 0.06F, 0.45F, 0.3F, 0.9F, 6, s.seed);
  // A hand-drawn diagram: frames and connecting strokes.
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float width_u = s.width_u / s.size_u;
  const float width_v = s.width_v / s.size_v;
  for (std::uint32_t k = 0; k < 5; ++k) {
    const std::uint32_t f = hash(s.seed + 13 * k + 1);
    const float u0 = 0.5F + 0.3F * uniform(f);
    const float v0 = 0.15F + 0.55F * uniform(hash(f + 1));
    const float u1 = u0 + 0.06F + 0.08F * uniform(hash(f + 2));
    const float v1 = v0 + 0.08F + 0.1F * uniform(hash(f + 3));
    const float pen_u = 0.008F / s.size_u;
    const float pen_v = 0.008F / s.size_v;
    const float outer = covered(u, width_u, u0, u1) * covered(v, width_v, v0, v1);
    const float inner =
        covered(u, width_u, u0 + pen_u, u1 - pen_u) * covered(v, width_v, v0 + pen_v, v1 - pen_v);
    ink = std::max(ink, outer - inner);
  }
  return mix(m.base * (1 + 0.02F * noise(s, 0.3F, 0.3F, 3, s.seed)), m.second, 0.85F * ink);
}

Rgb spine(const SurfaceSample& s) {
  const std::uint32_t h = hash(s.seed);
  const float v = s.v / s.size_v;
  const float width_v = s.width_v / s.size_v;
  Rgb colour = tint(h, 0.03F, 0.55F);
  const Rgb band = tint(hash(h + 9), 0.1F, 0.8F);
  const float at = 0.08F + 0.2F * uniform(hash(h + 3));
  colour = mix(colour, band, covered(v, width_v, at, at + 0.04F) + covered(v, width_v, 0.86F, 0.9F));
  const float title = covered(v, width_v, 0.4F, 0.8F) * covered_bars(s.v, s.width_v, 0.012F, 0.6F) *
                      covered(s.u / s.size_u, s.width_u / s.size_u, 0.3F, 0.7F);
  return mix(colour, band, 0.9F * title);
}

Rgb keyboard(const Material& m, const SurfaceSample& s) {
  const bool lengthwise = s.size_u >= s.size_v;
  const float pitch = 0.019F;
  const float keys = covered_bars(s.u - 0.002F, s.width_u, pitch, 0.82F) *
                     covered_bars(s.v - 0.002F, s.width_v, pitch, 0.82F);
  const float u = s.u / s.size_u;
  const float v = s.v / s.size_v;
  const float inside =
      covered(u, s.width_u / s.size_u, 0.03F, 0.97F) * covered(v, s.width_v / s.size_v, 0.03F, 0.97F);
  const float block = lengthwise ? covered(u, s.width_u / s.size_u, 0.7F, 0.74F)
                                 : covered(v, s.width_v / s.size_v, 0.7F, 0.74F);
  return mix(m.base, m.second, keys * inside * (1 - block));
}

}  // namespace

Rgb shade_material(const Material& m, const SurfaceSample& s, Rgb& emitted) {
  emitted = {};
  switch (m.pattern) {
    case Pattern::kPlain: return m.base * (1 + 0.02F * m.contrast * noise(s, 0.1F, 0.1F, 3, s.seed));
    case Pattern::kPlaster: {
      const float mottle =
          0.025F * noise(s, 0.7F, 0.7F, 3, s.seed) + 0.035F * noise(s, 0.05F, 0.05F, 4, s.seed + 50);
      const Rgb wall = m.base * (1 + m.contrast * mottle);
      const float scuff =
          marks(s, 0.55F, 0.3F, 0.035F, s.seed + 3) + marks(s, 0.17F, 0.12F, 0.012F, s.seed + 4);
      return mix(wall, m.second, m.contrast * 0.35F * clamp01(scuff));
    }
    case Pattern::kWood: return wood(m, s);
    case Pattern::kLinoleum: {
      const float speckle =
          0.05F * noise(s, 0.03F, 0.03F, 3, s.seed) + 0.05F * noise(s, 0.5F, 0.5F, 3, s.seed + 9);
      const Rgb ground = m.base * (1 + m.contrast * speckle);
      const float scratch =
          marks(s, 0.3F, 0.35F, 0.05F, s.seed + 1) + marks(s, 0.1F, 0.2F, 0.012F, s.seed + 2);
      return mix(ground, m.second, m.contrast * 0.4F * clamp01(scratch));
    }
    case Pattern::kTiles: return tiles(m, s, m.scale, m.scale, 0.006F, false);
    case Pattern::kBricks: return tiles(m, s, 0.25F, 0.08F, 0.01F, true);
    case Pattern::kCarpet:
      return mix(m.base, m.second,
                 clamp01(0.5F + m.contrast * (0.22F * noise(s, 0.025F, 0.025F, 3, s.seed) +
                                              0.1F * noise(s, 0.4F, 0.4F, 2, s.seed + 5))));
    case Pattern::kPoster: return poster(m, s);
    case Pattern::kPaper: return mix(m.base, m.second, 0.85F * text(s, 0.1F, 0.9F, 0.1F, 0.9F, 14, s.seed));
    case Pattern::kSpine: return spine(s);
    case Pattern::kScreen: return screen(m, s, emitted);
    case Pattern::kKeyboard: return keyboard(m, s);
    case Pattern::kWhiteboard: return whiteboard(m, s);
    case Pattern::kGrid: {
      const float bars_u = covered_bars(s.u, s.width_u, m.scale, 0.12F);
      const float bars_v = covered_bars(s.v, s.width_v, m.scale, 0.12F);
      return mix(m.base, m.second, bars_u + bars_v - bars_u * bars_v);
    }
    case Pattern::kWindow: return window(m, s, emitted);
    case Pattern::kLampPanel: emitted = m.base * m.emission; return m.base;
  }
  return m.base;
}

}  // namespace plvo::sim
