// SPDX-License-Identifier: Apache-2.0
// Reads the mask of a camera's images (Config::mask) from an image file, grey or in colours: what is white,
// or bright, is used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo {

// used: width × height bytes, 0 where the file is darker than middle grey. factor: images of the recording
// are scaled down by it (image_reduction.hpp); the file may then have their size as well. A scaled pixel is
// used where all that it covers are used. Returns kInvalidArgument, with the remedy, for a file of another
// size and for one that leaves no pixel; otherwise as ImageDecoder.
Status read_mask(const std::filesystem::path& file, int width, int height, int factor,
                 std::vector<std::uint8_t>& used);

}  // namespace plvo
