// SPDX-License-Identifier: Apache-2.0
// Any bytes as the messages of a player of .oni files, which may come from a damaged recording. Every image
// that is returned has the size of the stream and lies within its bytes.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "plvo/openni2/oni_messages.hpp"
#include "scratch_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plvo;
  using Message = OniMessageReader::Message;
  if (size == 0) return 0;
  // The first byte gives the number of bytes that arrive at once.
  const std::size_t step = 1 + data[0];
  ++data;
  --size;
  OniMessageReader reader;
  while (size > 0) {
    const std::span<std::uint8_t> space = reader.space();
    fuzz::require(!space.empty() && space.size() <= 16u << 20);
    const std::size_t n = std::min({space.size(), size, step});
    std::memcpy(space.data(), data, n);
    data += n;
    size -= n;
    const Message message = reader.advance(n);
    if (message == Message::kImage) {
      const DeviceImage& image = reader.image();
      const StreamFormat& format =
          image.stream == FramePairer::kColour ? reader.recording()->colour : reader.recording()->depth;
      if (image.data == nullptr) continue;
      fuzz::require(image.width == format.width && image.height == format.height && image.stamp_us >= 0);
      unsigned sum = 0;  // reads every byte, for the address sanitizer
      for (std::size_t i = 0; i < format.image_bytes(); ++i) sum += image.data[i];
      fuzz::require(sum <= 255 * format.image_bytes());
    }
    if (message == Message::kFailure || message == Message::kInvalid) {
      fuzz::require(!reader.failure().ok() && !std::string_view(reader.failure().message()).empty());
      return 0;
    }
  }
  return 0;
}
