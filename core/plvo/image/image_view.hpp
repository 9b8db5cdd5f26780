// SPDX-License-Identifier: Apache-2.0
// Images that the view does not own: a pointer, a size and a stride. Rows run from top to bottom.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>

namespace plvo {

template <typename T>
struct ImageView {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // elements between the starts of two rows

  T* row(int y) const {
    assert(y >= 0 && y < height);
    return data + y * stride;
  }
  T& at(int x, int y) const {
    assert(x >= 0 && x < width);
    return row(y)[x];
  }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  operator ImageView<const T>() const { return {data, width, height, stride}; }
};

using GrayView = ImageView<const std::uint8_t>;

enum class PixelFormat : std::uint8_t { kGray8, kRgb8, kBgr8 };

// The colour image as the camera delivers it.
struct ColourView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride_bytes = 0;
  PixelFormat format = PixelFormat::kRgb8;
};

// The depth image, registered to the colour image and of the same size. 0 means "no depth".
struct DepthView {
  const std::uint16_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;  // elements
  double metres_per_unit = 0.001;
};

}  // namespace plvo
