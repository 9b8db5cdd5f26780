// SPDX-License-Identifier: Apache-2.0
// PNG files with arbitrary chunks and correct checksums, and JPEG files with any frame header. Plain mutation
// never passes the first checksum. An accepted image has a size within the reader's limits.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/replay/images/image_decoder.hpp"
#include "scratch_file.hpp"

namespace {

using namespace plvo;

std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ ((c & 1) != 0 ? 0xedb88320u : 0u);
      t[n] = c;
    }
    return t;
  }();
  std::uint32_t crc = ~0u;
  for (const char c : bytes) crc = (crc >> 8) ^ table[(crc ^ static_cast<unsigned char>(c)) & 255];
  return ~crc;
}

void put(std::string& file, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(value >> shift);
}

constexpr std::array<std::string_view, 16> kTypes = {"IHDR", "IDAT", "PLTE", "tRNS", "zTXt", "iTXt",
                                                     "tEXt", "iCCP", "sPLT", "gAMA", "sBIT", "bKGD",
                                                     "hIST", "eXIf", "IDAT", "IEND"};

// The first 13 bytes are the header. Then each chunk is a type, a length and its bytes.
std::string as_png(std::string_view bytes) {
  std::string file = "\x89PNG\r\n\x1a\n";
  const auto add = [&file](std::string_view type, std::string_view data) {
    put(file, static_cast<std::uint32_t>(data.size()));
    const std::size_t begin = file.size();
    file.append(type).append(data);
    put(file, crc32(std::string_view(file).substr(begin)));
  };
  std::string header(bytes.substr(0, 13));
  header.resize(13);
  add("IHDR", header);
  bytes.remove_prefix(std::min<std::size_t>(bytes.size(), 13));
  while (bytes.size() >= 2) {
    const std::string_view type = kTypes[static_cast<unsigned char>(bytes[0]) % kTypes.size()];
    const std::string_view data = bytes.substr(2, static_cast<unsigned char>(bytes[1]));
    add(type, data);
    bytes.remove_prefix(2 + data.size());
  }
  add("IEND", "");
  return file;
}

std::string as_jpeg(std::string_view bytes) {
  static constexpr std::array<char, 4> kFrames = {'\xc0', '\xc1', '\xc2', '\xc9'};
  std::string file = "\xff\xd8";
  if (bytes.empty()) return file;
  const char frame = kFrames[static_cast<unsigned char>(bytes[0]) % kFrames.size()];
  file.append("\xff").append(1, frame);
  return file.append(bytes.substr(1));
}

void check(const std::string& file) {
  const auto path =
      fuzz::write_scratch("image", reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  ImageDecoder decoder;
  ImageInfo info;
  const Status status = decoder.read_header(path, info);
  if (!status.ok()) return fuzz::require(!std::string_view(status.message()).empty());
  fuzz::require(info.width > 0 && info.height > 0 && info.width <= kMaxImageSide &&
                info.height <= kMaxImageSide);
  if (info.width * info.height > 1 << 16) return;  // enough for the sanitizers to check
  const auto pixels = static_cast<std::size_t>(info.width * info.height);
  std::vector<std::uint8_t> rgb(3 * pixels);
  std::vector<std::uint16_t> depth(pixels);
  (void)decoder.decode_rgb(path, info.width, info.height, rgb);
  (void)decoder.decode_depth(path, info.width, info.height, depth);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  check(as_png(bytes));
  check(as_jpeg(bytes));
  return 0;
}
