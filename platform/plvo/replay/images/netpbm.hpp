// SPDX-License-Identifier: Apache-2.0
// Reads binary Netpbm images: PGM (P5, grey) and PPM (P6, RGB), of 8 bits, or of 16 bits with the more
// significant byte first. Images in text (P2, P3) and of other kinds are refused; the message names the
// kinds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/status.hpp"

namespace plvo {

struct NetpbmHeader {
  int width = 0, height = 0;  // px, not checked yet
  int most = 0;               // the value of white, at most 65535; above 255 a number has two bytes
  bool grey = false;
  std::size_t size = 0;  // bytes of the file before the pixels
};

// Whether the file begins like a Netpbm image, readable or not.
bool is_netpbm(std::span<const unsigned char> file);

// Messages do not name the file. Returns kUnsupported: another kind of Netpbm image; kDamaged: a header that
// cannot be parsed.
Status read_netpbm_header(std::span<const unsigned char> file, NetpbmHeader& header);

// Reads the pixels as 8-bit RGB, with white as 255. rgb: width·height·3 bytes. Returns kDamaged: cut off.
Status read_netpbm_rgb(std::span<const unsigned char> file, const NetpbmHeader& header,
                       std::span<std::uint8_t> rgb);

// Reads the values of a 16-bit grey image unchanged. depth: width·height values. Returns kDamaged: cut off.
Status read_netpbm_depth(std::span<const unsigned char> file, const NetpbmHeader& header,
                         std::span<std::uint16_t> depth);

}  // namespace plvo
