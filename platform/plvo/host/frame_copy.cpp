// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/frame_copy.hpp"

#include <algorithm>
#include <cstring>

namespace plvo {
namespace {

// Copies rows of row_bytes that begin stride_bytes apart into the buffer, which is returned.
template <typename T>
const T* copy_rows(const T* from, std::ptrdiff_t stride, std::size_t row_length, int height,
                   std::vector<T>& to) {
  if (from == nullptr) return nullptr;
  const std::size_t size = row_length * static_cast<std::size_t>(std::max(height, 0));
  if (to.size() < size) to.resize(size);
  for (int y = 0; y < height; ++y)
    std::memcpy(to.data() + static_cast<std::size_t>(y) * row_length, from + y * stride,
                row_length * sizeof(T));
  return to.data();
}

}  // namespace

void FrameCopy::reserve(std::size_t pixels) {
  if (colour_.size() < pixels * 3) colour_.resize(pixels * 3);
  if (depth_.size() < pixels) depth_.resize(pixels);
}

void FrameCopy::assign(const RgbdFrame& frame) {
  frame_ = frame;
  ColourView& colour = frame_.colour;
  const std::size_t colour_row =
      static_cast<std::size_t>(std::max(colour.width, 0)) * (colour.format == PixelFormat::kGray8 ? 1 : 3);
  colour.data = copy_rows(colour.data, colour.stride_bytes, colour_row, colour.height, colour_);
  colour.stride_bytes = static_cast<std::ptrdiff_t>(colour_row);
  DepthView& depth = frame_.depth;
  const auto depth_row = static_cast<std::size_t>(std::max(depth.width, 0));
  depth.data = copy_rows(depth.data, depth.stride, depth_row, depth.height, depth_);
  depth.stride = depth.width;
}

}  // namespace plvo
