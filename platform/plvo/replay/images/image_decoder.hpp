// SPDX-License-Identifier: Apache-2.0
// Decodes image files into the caller's pixels: PNG of any colour type (libspng), JPEG (TurboJPEG), PGM and
// PPM (netpbm.hpp) as RGB; grey PNG and PGM of 16 bits as depth. One file buffer is reused; after reserve()
// it does not grow. The size in a header is compared with the limits below before memory of that size is
// allocated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/replay/images/netpbm.hpp"

namespace plvo {

inline constexpr int kMaxImageSide = 4096;  // px of a file; images beyond the core's limit are scaled down
inline constexpr std::uintmax_t kMaxImageBytes = 64u
                                                 << 20;  // of a file; no 8-bit image of that size has as many

struct ImageInfo {
  int width = 0;
  int height = 0;
  int bits = 0;  // per channel
  bool grey = false;

  // Returns kInvalidArgument, with the remedy, for an image that cannot be depth. path: names the file in the
  // message.
  Status check_is_depth(const std::filesystem::path& path) const;
  Status check_is_depth() const;
};

class ImageDecoder {
 public:
  ImageDecoder() = default;
  ImageDecoder(const ImageDecoder&) = delete;
  ImageDecoder& operator=(const ImageDecoder&) = delete;
  ~ImageDecoder();

  // Sets the size of the largest file that will be read, in bytes. Writes to the memory, so that the system
  // really provides it.
  void reserve(std::size_t file_bytes) { file_.resize(file_bytes); }

  // Messages name the file. Returns kNotFound: no such file; kDamaged: not an image, or cut off;
  // kInvalidArgument: larger than the limits, or not a regular file.
  Status read_header(const std::filesystem::path& path, ImageInfo& info);
  // rgb: width·height·3 bytes. Returns kInvalidArgument if the image has another size.
  Status decode_rgb(const std::filesystem::path& path, int width, int height, std::span<std::uint8_t> rgb);
  // depth: width·height values in the file's unit. Returns kInvalidArgument for another size, or for depth
  // without 16 bits.
  Status decode_depth(const std::filesystem::path& path, int width, int height,
                      std::span<std::uint16_t> depth);

  // The same for the bytes of a file; messages name none.
  Status read_header(std::span<const unsigned char> file, ImageInfo& info);
  Status decode_rgb(std::span<const unsigned char> file, int width, int height, std::span<std::uint8_t> rgb);
  Status decode_depth(std::span<const unsigned char> file, int width, int height,
                      std::span<std::uint16_t> depth);

 private:
  Status load(const std::filesystem::path& path);
  Status jpeg_header(std::span<const unsigned char> file, ImageInfo& info);

  std::vector<unsigned char> file_;
  void* jpeg_ = nullptr;  // TurboJPEG's handle, created for the first JPEG
};

}  // namespace plvo
