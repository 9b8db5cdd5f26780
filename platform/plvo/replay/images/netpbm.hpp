// SPDX-License-Identifier: Apache-2.0
// Netpbm's images of raw numbers: PGM (P5, grey) and PPM (P6, RGB), of 8 bits, or of 16 with the more
// significant byte first. Those in text (P2, P3) and of other kinds are refused by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/status.hpp"

namespace plvo {

struct NetpbmHeader {
  int width = 0, height = 0;  // px, not compared with anything yet
  int most = 0;               // the value of white, at most 65535; above 255 a number has two bytes
  bool grey = false;
  std::size_t size = 0;  // bytes of the file before the pixels
};

// Whether it begins as one of Netpbm's images does, readable or not.
bool is_netpbm(std::span<const unsigned char> file);

// Messages do not name the file. kUnsupported: another kind of Netpbm's; kDamaged: a header that is not
// understood.
Status read_netpbm_header(std::span<const unsigned char> file, NetpbmHeader& header);

// The pixels as 8-bit RGB, white being 255. rgb: width·height·3 bytes. kDamaged: cut off.
Status read_netpbm_rgb(std::span<const unsigned char> file, const NetpbmHeader& header,
                       std::span<std::uint8_t> rgb);

// Of grey with 16 bits the numbers as they stand. depth: width·height values. kDamaged: cut off.
Status read_netpbm_depth(std::span<const unsigned char> file, const NetpbmHeader& header,
                         std::span<std::uint16_t> depth);

}  // namespace plvo
