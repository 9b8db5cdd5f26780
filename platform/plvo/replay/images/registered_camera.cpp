// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/registered_camera.hpp"

#include <algorithm>

namespace plvo {

Status RegisteredCamera::next(RgbdFrame& frame) {
  Status status = source_.next(frame);
  if (!status.ok()) return status;
  const DepthView raw = frame.depth;
  const CameraModel colour = source_.model();
  if (raw.width != width_ || raw.height != height_ || raw.metres_per_unit != metres_per_unit_) {
    DepthCamera depth = depth_;
    if (depth.as_colour) depth.pinhole = colour.pinhole;
    depth.as_colour = false;
    registration_.init(colour, {1, colour.width, colour.height}, depth, raw.width, raw.height,
                       raw.metres_per_unit);
    width_ = raw.width;
    height_ = raw.height;
    metres_per_unit_ = raw.metres_per_unit;
    packed_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    registered_.resize(static_cast<std::size_t>(colour.width) * static_cast<std::size_t>(colour.height));
  }
  for (int v = 0; v < height_; ++v)
    std::copy_n(raw.data + v * raw.stride, width_, packed_.data() + static_cast<std::ptrdiff_t>(v) * width_);
  registration_.warp(packed_.data(), registered_.data());
  frame.depth.data = registered_.data();
  frame.depth.width = colour.width;
  frame.depth.height = colour.height;
  frame.depth.stride = colour.width;
  return {};
}

}  // namespace plvo
