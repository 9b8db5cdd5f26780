// SPDX-License-Identifier: Apache-2.0
// Unpacks the compressed chunks of a bag.
#pragma once

#include <span>
#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

enum class BagCompression : unsigned char { kNone, kBz2, kLz4 };

// Finds the compression by its name in the bag. Returns false for an unknown one.
bool compression_of(std::string_view name, BagCompression& compression);

// unpacked: has the size stated in the bag. Returns kDamaged if the bytes do not unpack to exactly this size;
// kOutOfMemory.
Status unpack_chunk(BagCompression compression, std::span<const unsigned char> packed,
                    std::span<unsigned char> unpacked);

}  // namespace plvo
