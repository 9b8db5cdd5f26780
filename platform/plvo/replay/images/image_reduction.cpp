// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/image_reduction.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/odometry/config.hpp"

namespace plvo {

int least_reduction(int width, int height) {
  int factor = 1;
  while (std::max(width, height) / factor > Limits::kMostSide) ++factor;
  return factor;
}

Status check_reduction(int factor, int width, int height) {
  if (factor < 1)
    return {StatusCode::kInvalidArgument, "images are scaled down by a whole number that is at least 1"};
  const int small_width = width / factor, small_height = height / factor;
  const bool fits = std::max(small_width, small_height) <= Limits::kMostSide;
  // Images that are too small without scaling get another message elsewhere.
  if (fits && (factor == 1 || std::min(small_width, small_height) >= Limits::kLeastSide)) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("images of {}x{} scaled down by {} are {}x{}, and plvo takes {}x{} to {}x{}", width,
                      height, factor, small_width, small_height, Limits::kLeastSide, Limits::kLeastSide,
                      Limits::kMostSide, Limits::kMostSide)};
}

CameraModel reduced(const CameraModel& camera, int factor) {
  if (factor == 1) return camera;  // exact to the last bit
  CameraModel small = camera;
  small.width = camera.width / factor;
  small.height = camera.height / factor;
  const double s = factor;
  small.pinhole = {camera.pinhole.fx / s, camera.pinhole.fy / s, (camera.pinhole.cx + 0.5) / s - 0.5,
                   (camera.pinhole.cy + 0.5) / s - 0.5};
  // Share of the readout between the centres of the first and the last row of the small image.
  const double share = s * (small.height - 1) / (camera.height - 1);
  small.readout_s *= share;
  small.depth_timing.readout_s *= share;
  return small;
}

void reduce_rgb(const std::uint8_t* rgb, int width, int factor, int out_width, int out_height,
                std::uint8_t* out) {
  const std::ptrdiff_t stride = 3 * static_cast<std::ptrdiff_t>(width);
  const unsigned count = static_cast<unsigned>(factor * factor);
  for (int y = 0; y < out_height; ++y) {
    const std::uint8_t* column = rgb + y * factor * stride;
    for (int x = 0; x < out_width; ++x, column += std::ptrdiff_t{3} * factor) {
      unsigned sum[3] = {count / 2, count / 2, count / 2};  // rounds
      for (int row = 0; row < factor; ++row) {
        const std::uint8_t* pixel = column + row * stride;
        for (int i = 0; i < factor; ++i, pixel += 3)
          for (int c = 0; c < 3; ++c) sum[c] += pixel[c];
      }
      for (const unsigned s : sum) *out++ = static_cast<std::uint8_t>(s / count);
    }
  }
}

}  // namespace plvo
