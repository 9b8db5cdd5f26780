// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/depth_sampler.hpp"

#include <algorithm>
#include <array>

#include "plvo/math/trigonometry.hpp"

namespace plvo {

DepthSample DepthSampler::sample(double u, double v, int radius) const {
  constexpr int kMaxRadius = 3;
  constexpr int kMaxWindow = (2 * kMaxRadius + 1) * (2 * kMaxRadius + 1);
  std::array<double, kMaxWindow> window;
  std::size_t count = 0;
  const int x0 = static_cast<int>(u + 0.5);
  const int y0 = static_cast<int>(v + 0.5);
  radius = std::min(radius, kMaxRadius);
  double nearest = 0;
  for (int y = y0 - radius; y <= y0 + radius; ++y) {
    for (int x = x0 - radius; x <= x0 + radius; ++x) {
      const double z = at(x, y);
      if (z <= 0) continue;
      window[count++] = z;
      if (nearest == 0 || z < nearest) nearest = z;
    }
  }
  const auto side = static_cast<std::size_t>(2 * radius + 1);
  // Where half the window has no depth, the rest is a rim of bad depth.
  if (2 * count < side * side) return {};

  // A jump is what neither noise nor a steep surface explains: 6 σ and 4 % of the depth.
  const double sigma = noise_.sigma(nearest);
  const double jump = std::max(6 * sigma, 0.04 * nearest);
  double sum = 0;
  double sum_squared = 0;
  std::size_t near_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = window[i];
    if (z > nearest + jump) continue;
    const double offset = z - nearest;  // small numbers keep their digits when squared
    sum += offset;
    sum_squared += offset * offset;
    ++near_count;
  }
  const auto n = static_cast<double>(near_count);
  const double mean = sum / n;
  const double variance = std::max(0.0, sum_squared / n - mean * mean);

  DepthSample result;
  result.depth_m = nearest + mean;
  result.on_edge = near_count < count;
  // The spread within the window is noise plus slope × misregistration of about a pixel: both belong to the
  // pixel's depth. A mixed window leaves the nearer surface's own depth less sure.
  const double sigma_d = noise_.sigma(result.depth_m);
  result.sigma_m = sqrt(std::max(sigma_d * sigma_d, 0.5 * sigma_d * sigma_d + variance));
  if (result.on_edge) result.sigma_m *= 2;
  return result;
}

}  // namespace plvo
