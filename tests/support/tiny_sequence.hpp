// SPDX-License-Identifier: Apache-2.0
// A small TUM folder made on the spot: `frames` images of a textured wall, 96×64, 30 Hz from stamp 100 s.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "plvo/replay/tum_writer.hpp"

namespace plvo::test {

inline constexpr int kTinyWidth = 96;
inline constexpr int kTinyHeight = 64;
inline constexpr std::int64_t kTinyFirstStamp = 100'000'000'000;
inline constexpr std::int64_t kTinyStep = 33'333'000;

inline std::int64_t tiny_stamp(int frame) { return kTinyFirstStamp + frame * kTinyStep; }

inline CameraModel tiny_camera() {
  CameraModel camera;
  camera.width = kTinyWidth;
  camera.height = kTinyHeight;
  camera.pinhole = {80, 80, 47.5, 31.5};
  return camera;
}

struct TinyFrame {
  explicit TinyFrame(int number, int width = kTinyWidth, int height = kTinyHeight)
      : rgb(static_cast<std::size_t>(width * height * 3)), depth(static_cast<std::size_t>(width * height)) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(y * width + x);
        const bool bright = (((x + number) / 8) + (y / 8)) % 2 == 0;
        for (std::size_t c = 0; c < 3; ++c)
          rgb[3 * i + c] = static_cast<std::uint8_t>((bright ? 180 : 60) + static_cast<int>(c) * 10 + x % 7);
        depth[i] = static_cast<std::uint16_t>(5000 + 10 * x + y);
      }
    }
    frame.stamp_ns = tiny_stamp(number);
    frame.depth_stamp_ns = frame.stamp_ns + 5'000'000;
    frame.colour = {rgb.data(), width, height, width * std::ptrdiff_t{3}, PixelFormat::kRgb8};
    frame.depth = {depth.data(), width, height, width, 1.0 / 5000};
  }
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint16_t> depth;
  RgbdFrame frame;
};

inline Status write_tiny_sequence(const std::filesystem::path& folder, int frames) {
  TumWriter writer;
  Status status = writer.open(folder, tiny_camera(), 5000);
  for (int i = 0; i < frames && status.ok(); ++i) status = writer.write(TinyFrame(i).frame);
  return status;
}

}  // namespace plvo::test
