// SPDX-License-Identifier: Apache-2.0
// Writes pixels into image files: PNG for exact images (colour, depth), JPEG in memory for display.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/image/frame.hpp"

namespace plvo {

// Returns kIo, with the operating system's reason, if the file cannot be written completely.
Status write_png(const std::filesystem::path& path, const ColourView& image);
Status write_png(const std::filesystem::path& path, const DepthView& image);  // 16-bit grey

// quality: 1 … 100. Empty when the image is empty.
std::vector<std::uint8_t> encode_jpeg(const ColourView& image, int quality);

}  // namespace plvo
