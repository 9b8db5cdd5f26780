// SPDX-License-Identifier: Apache-2.0
// How much memory a reader takes, whatever a file says of itself: kMostReaderBytes at the most for one file,
// folder or bag, with everything that is derived of it while it is opened. The limits below keep each reader
// within that, together with those of its kind of file (kMaxTextBytes, kMaxImageSide, a bag's kMaxPiece); the
// tests reader_memory_test and bag_memory_test measure it.
#pragma once

#include <cstddef>

namespace plvo {

inline constexpr std::size_t kMostReaderBytes = std::size_t{512} << 20;

// Images of a list, a bag or a folder of numbered frames. As many uncompressed 640x480 images of colour and
// depth would fill 800 GB.
inline constexpr std::size_t kMostImages = std::size_t{1} << 20;
inline constexpr std::size_t kMostRows = std::size_t{1} << 21;      // of a table of numbers
inline constexpr std::size_t kMostColumns = 256;                    // of one row
inline constexpr std::size_t kMostReadings = std::size_t{1} << 22;  // of gyros and accelerometers in a bag
inline constexpr std::size_t kMostNameBytes = 4096;  // of a file's or a topic's name; no path is longer

}  // namespace plvo
