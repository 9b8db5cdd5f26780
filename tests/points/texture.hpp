// SPDX-License-Identifier: Apache-2.0
// A smooth random texture that can be evaluated anywhere, so that sub-pixel shifts are exact. It is a sum of
// value noises of several grain sizes, interpolated by a cubic B-spline.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/base/random.hpp"

namespace plvo::test {

class Texture {
 public:
  explicit Texture(std::uint64_t seed, double contrast = 55, double grain = 1)
      : contrast_(contrast), grain_(grain) {
    Random random(seed);
    for (float& value : lattice_) value = static_cast<float>(2 * random.uniform() - 1);
  }

  // Grey level, roughly 127 ± 2 · contrast, with grains of 5, 11 and 24 px times `grain`.
  double operator()(double x, double y) const {
    x /= grain_;
    y /= grain_;
    return 127 + contrast_ * (1.6 * noise(x / 5, y / 5, 0) + 1.3 * noise(x / 11, y / 11, 17) +
                              1.0 * noise(x / 24, y / 24, 41));
  }

 private:
  static constexpr int kSide = 128;

  static std::array<double, 4> weights(double t) {
    const double s = 1 - t;
    return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
            t * t * t / 6};
  }
  double noise(double x, double y, int salt) const {
    // Adding whole grains makes truncation round down. The texture repeats after kSide grains, so its value
    // stays the same.
    constexpr int kWhole = 8 * kSide;
    const int x_floor = static_cast<int>(x + kWhole);
    const int y_floor = static_cast<int>(y + kWhole);
    const std::array<double, 4> wx = weights(x + kWhole - x_floor);
    const std::array<double, 4> wy = weights(y + kWhole - y_floor);
    const auto x0 = static_cast<unsigned>(x_floor - 1 + salt);
    const auto y0 = static_cast<unsigned>(y_floor - 1 + 3 * salt);
    double sum = 0;
    for (unsigned j = 0; j < 4; ++j) {
      const float* row = lattice_.data() + ((y0 + j) % kSide) * kSide;
      for (unsigned i = 0; i < 4; ++i) sum += wy[j] * wx[i] * static_cast<double>(row[(x0 + i) % kSide]);
    }
    return sum;
  }

  double contrast_, grain_;
  std::array<float, kSide * kSide> lattice_{};
};

// An approximately standard normal number: the sum of twelve uniform numbers minus its mean (Irwin–Hall; the
// tails end at 6).
inline double gaussian(Random& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

}  // namespace plvo::test
