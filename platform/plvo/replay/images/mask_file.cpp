// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/mask_file.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/image/gray.hpp"
#include "plvo/replay/images/image_decoder.hpp"

namespace plvo {
namespace {

constexpr std::uint8_t kLeastBright = 128;

}  // namespace

Status read_mask(const std::filesystem::path& file, int width, int height, int factor,
                 std::vector<std::uint8_t>& used) {
  ImageDecoder decoder;
  ImageInfo info;
  if (Status status = decoder.read_header(file, info); !status.ok()) return status;
  // The columns and rows left over, fewer than the factor, are cut off.
  const bool whole = info.width / factor == width && info.height / factor == height;
  if (!whole && (info.width != width || info.height != height))
    return {
        StatusCode::kInvalidArgument,
        fmt::format("{}: the mask has {}x{} pixels, the camera's images have {}x{}{}; draw it over one of "
                    "the colour images",
                    file.string(), info.width, info.height, width, height,
                    factor > 1 ? fmt::format(", scaled down by {}", factor) : "")};
  const auto pixels = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height);
  std::vector<std::uint8_t> rgb(3 * pixels), gray(pixels);
  if (Status status = decoder.decode_rgb(file, info.width, info.height, rgb); !status.ok()) return status;
  to_gray({rgb.data(), info.width, info.height, 3 * std::ptrdiff_t{info.width}, PixelFormat::kRgb8},
          {gray.data(), info.width, info.height, info.width});
  const int step = whole ? factor : 1;
  used.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255);
  for (int y = 0; y < height * step; ++y)
    for (int x = 0; x < width * step; ++x)
      if (gray[static_cast<std::size_t>(y) * static_cast<std::size_t>(info.width) +
               static_cast<std::size_t>(x)] < kLeastBright)
        used[static_cast<std::size_t>(y / step) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(x / step)] = 0;
  if (std::find(used.begin(), used.end(), 255) == used.end())
    return {
        StatusCode::kInvalidArgument,
        fmt::format("{}: the mask leaves no pixel to be used: white is used, black is not", file.string())};
  return {};
}

}  // namespace plvo
