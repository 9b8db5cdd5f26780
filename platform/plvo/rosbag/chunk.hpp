// SPDX-License-Identifier: Apache-2.0
// The pieces that a bag is compressed in.
#pragma once

#include <span>
#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

enum class BagCompression : unsigned char { kNone, kBz2, kLz4 };

// By the name in the bag; false for another.
bool compression_of(std::string_view name, BagCompression& compression);

// unpacked: of the size that the bag says. kDamaged where the bytes do not give exactly as many;
// kOutOfMemory.
Status unpack_chunk(BagCompression compression, std::span<const unsigned char> packed,
                    std::span<unsigned char> unpacked);

}  // namespace plvo
