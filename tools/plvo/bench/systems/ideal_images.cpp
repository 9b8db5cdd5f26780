// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/systems/ideal_images.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::bench {
namespace {

// A pixel's three channels in the order red, green, blue.
struct Channels {
  int count = 3;
  int first = 0, step = 1;
  int at(int channel) const { return first + step * channel; }
};

Channels channels_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kGray8: return {1, 0, 0};
    case PixelFormat::kBgr8: return {3, 2, -1};
    case PixelFormat::kRgb8: break;
  }
  return {};
}

}  // namespace

IdealImages::IdealImages(const CameraModel& camera) : width_(camera.width), height_(camera.height) {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  sources_.reserve(pixels);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Vector2 raw = camera.distortion.is_zero() ? Vector2(x, y) : distort_pixel(camera, Vector2(x, y));
      Source source;
      if (raw.x() >= 0 && raw.y() >= 0 && raw.x() <= width_ - 1 && raw.y() <= height_ - 1) {
        source.x = std::min(static_cast<int>(raw.x()), width_ - 2);
        source.y = std::min(static_cast<int>(raw.y()), height_ - 2);
        source.u = static_cast<float>(raw.x() - source.x);
        source.v = static_cast<float>(raw.y() - source.y);
      }
      sources_.push_back(source);
    }
  }
  rgb_.resize(3 * pixels);
  depth_.resize(pixels);
}

void IdealImages::make(const RgbdFrame& frame) {
  const Channels channels = channels_of(frame.colour.format);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& s = sources_[i];
    std::uint8_t* out = rgb_.data() + 3 * i;
    if (s.x < 0) {
      std::fill(out, out + 3, std::uint8_t{0});
      depth_[i] = 0;
      continue;
    }
    const std::uint8_t* top = frame.colour.data + s.y * frame.colour.stride_bytes + s.x * channels.count;
    const std::uint8_t* bottom = top + frame.colour.stride_bytes;
    for (int channel = 0; channel < 3; ++channel) {
      const int left = channels.at(channel);
      const int right = left + channels.count;
      const auto between = [&](const std::uint8_t* row) {
        return static_cast<float>(row[left]) * (1 - s.u) + static_cast<float>(row[right]) * s.u;
      };
      out[channel] = static_cast<std::uint8_t>(between(top) * (1 - s.v) + between(bottom) * s.v + 0.5F);
    }
    depth_[i] =
        frame.depth.data[(s.y + (s.v >= 0.5F ? 1 : 0)) * frame.depth.stride + s.x + (s.u >= 0.5F ? 1 : 0)];
  }
}

}  // namespace plvo::bench
