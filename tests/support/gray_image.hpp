// SPDX-License-Identifier: Apache-2.0
// A grey image that owns its pixels, with a stride of its own: rows are a few pixels longer than they look,
// and tests can see whether somebody wrote there.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo::test {

class GrayImage {
 public:
  GrayImage(int width, int height, int padding = 0, std::uint8_t fill = 0)
      : width_(width),
        height_(height),
        stride_(width + padding),
        pixels_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height), fill) {}

  ImageView<std::uint8_t> view() { return {pixels_.data(), width_, height_, stride_}; }
  GrayView view() const { return {pixels_.data(), width_, height_, stride_}; }
  std::vector<std::uint8_t>& pixels() { return pixels_; }
  const std::vector<std::uint8_t>& pixels() const { return pixels_; }
  int width() const { return width_; }
  int height() const { return height_; }

  // Every pixel from f(x, y), rounded and clamped to 0 … 255.
  template <typename Function>
  void paint(Function f) {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) view().at(x, y) = to_byte(f(x, y));
  }
  static std::uint8_t to_byte(double value) {
    return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : std::floor(value + 0.5));
  }

 private:
  int width_, height_, stride_;
  std::vector<std::uint8_t> pixels_;
};

inline GrayImage random_image(int width, int height, Random& random, int padding = 0) {
  GrayImage image(width, height, padding);
  for (std::uint8_t& pixel : image.pixels()) pixel = static_cast<std::uint8_t>(random.below(256));
  return image;
}

}  // namespace plvo::test
