// SPDX-License-Identifier: Apache-2.0
// Unpacks what recorders compress: chunks of bags and MCAP files, single messages and whole files of rosbag2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo {

enum class Compression : unsigned char { kNone, kBz2, kLz4, kZstd };

// Finds the compression by its name in a file; an empty name means none. Returns false for an unknown one.
bool compression_of(std::string_view name, Compression& compression);

// unpacked: has the size stated in the file. Returns kDamaged if the bytes do not unpack to exactly this
// size; kOutOfMemory.
Status unpack_chunk(Compression compression, std::span<const unsigned char> packed,
                    std::span<unsigned char> unpacked);

// Whether the bytes begin like those of zstd. No message that is not compressed begins so.
bool is_zstd(std::span<const unsigned char> bytes);

// Unpacks a message of at most `most` bytes. Returns kDamaged.
Status unpack_zstd_message(std::span<const unsigned char> packed, std::size_t most,
                           std::vector<unsigned char>& unpacked);
// Unpacks the first bytes only. Returns kDamaged if there are fewer.
Status unpack_zstd_start(std::span<const unsigned char> packed, std::span<unsigned char> start);

// Unpacks a whole file to a file of at most `most` bytes. Returns kDamaged, naming the packed file; kIo.
Status unpack_zstd_file(const std::filesystem::path& packed, std::uintmax_t most,
                        const std::filesystem::path& unpacked);

}  // namespace plvo
