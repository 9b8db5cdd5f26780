// SPDX-License-Identifier: Apache-2.0
// Any bytes as an image file, decoded as colour and as depth into buffers that the address sanitizer checks.
#include <string_view>
#include <vector>

#include "plvo/replay/images/image_decoder.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  const auto path = fuzz::write_scratch("image.png", data, size);
  ImageDecoder decoder;
  ImageInfo info;
  const Status status = decoder.read_header(path, info);
  fuzz::require(status.ok() || !std::string_view(status.message()).empty());
  if (!status.ok()) return 0;
  fuzz::require(info.width > 0 && info.height > 0 && info.width <= kMaxImageSide &&
                info.height <= kMaxImageSide);
  const auto pixels = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height);
  std::vector<std::uint8_t> rgb(3 * pixels);
  std::vector<std::uint16_t> depth(pixels);
  (void)decoder.decode_rgb(path, info.width, info.height, rgb);
  (void)decoder.decode_depth(path, info.width, info.height, depth);
  return 0;
}
