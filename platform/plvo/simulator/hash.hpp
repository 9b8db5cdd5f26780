// SPDX-License-Identifier: Apache-2.0
// Random numbers as a function of position (a pixel, a lattice node), not of the order of calls. An image
// therefore does not depend on the number of threads. The integer hash is the PCG variant recommended by
// Jarzynski & Olano, "Hash Functions for GPU Rendering", JCGT 2020.
#pragma once

#include <cstdint>

#include "plvo/math/types.hpp"

namespace plvo::sim {

constexpr std::uint32_t hash(std::uint32_t x) {
  const std::uint32_t state = x * 747796405U + 2891336453U;
  const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737U;
  return (word >> 22) ^ word;
}
constexpr std::uint32_t hash(std::uint32_t x, std::uint32_t y) { return hash(x + hash(y)); }
constexpr std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return hash(x + hash(y + hash(z)));
}

// The seed of one sensor's random numbers.
constexpr std::uint32_t sensor_seed(std::uint64_t seed, std::uint32_t sensor) {
  return hash(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), sensor);
}

// [0, 1), a multiple of 2^-24.
constexpr float uniform(std::uint32_t h) { return static_cast<float>(h >> 8) * (1.0F / 16777216.0F); }
// [−1, 1).
constexpr float signed_uniform(std::uint32_t h) { return uniform(h) * 2.0F - 1.0F; }

// Zero mean, unit variance, nearly Gaussian: the sum of eight independent uniforms of eight bits
// (Irwin–Hall), bounded by ±4.9.
constexpr float gaussian(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t even =
      (a & 0x00ff00ffU) + ((a >> 8) & 0x00ff00ffU) + (b & 0x00ff00ffU) + ((b >> 8) & 0x00ff00ffU);
  const std::uint32_t sum = (even & 0xffffU) + (even >> 16);
  // Mean 8·127.5, variance 8·(256² − 1)/12.
  return (static_cast<float>(sum) - 1020.0F) * (1.0F / 209.0207F);
}
constexpr float gaussian(std::uint32_t h) { return gaussian(h, hash(h ^ 0x9e3779b9U)); }
// Three of them, one for each axis.
inline Vector3 gaussian_vector(std::uint32_t a, std::uint32_t b, std::uint32_t seed) {
  Vector3 values;
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    values(axis) = static_cast<double>(gaussian(hash(a, hash(b, axis), seed)));
  return values;
}

// Smooth noise in [−1, 1] over the plane: hashed values on the integer lattice with cubic interpolation.
inline float value_noise(float x, float y, std::uint32_t seed) {
  const float floor_x = static_cast<float>(static_cast<int>(x) - (x < 0 ? 1 : 0));
  const float floor_y = static_cast<float>(static_cast<int>(y) - (y < 0 ? 1 : 0));
  const auto ix = static_cast<std::uint32_t>(static_cast<std::int32_t>(floor_x));
  const auto iy = static_cast<std::uint32_t>(static_cast<std::int32_t>(floor_y));
  const float dx = x - floor_x;
  const float dy = y - floor_y;
  const float sx = dx * dx * (3.0F - 2.0F * dx);
  const float sy = dy * dy * (3.0F - 2.0F * dy);
  const std::uint32_t row0 = hash(iy ^ seed);
  const std::uint32_t row1 = hash((iy + 1) ^ seed);
  const float n00 = signed_uniform(hash(ix + row0));
  const float n10 = signed_uniform(hash(ix + 1 + row0));
  const float n01 = signed_uniform(hash(ix + row1));
  const float n11 = signed_uniform(hash(ix + 1 + row1));
  const float top = n00 + (n10 - n00) * sx;
  const float bottom = n01 + (n11 - n01) * sx;
  return top + (bottom - top) * sy;
}

}  // namespace plvo::sim
