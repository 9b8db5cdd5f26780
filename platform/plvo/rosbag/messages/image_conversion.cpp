// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/messages/image_conversion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>

namespace plvo {
namespace {

using Content = ImageMessage::Content;

// Layout of a pixel in memory: positions of red, green and blue.
struct ColourLayout {
  std::string_view encoding;
  std::size_t bytes, red, green, blue;
};
constexpr ColourLayout kColourLayouts[] = {{"rgb8", 3, 0, 1, 2},  {"bgr8", 3, 2, 1, 0},
                                           {"rgba8", 4, 0, 1, 2}, {"bgra8", 4, 2, 1, 0},
                                           {"8UC3", 3, 2, 1, 0},  {"mono8", 1, 0, 0, 0}};

// Positions of the red pixel in each 2 × 2 block; blue is diagonally opposite.
struct BayerPattern {
  std::string_view encoding;
  int red_x, red_y;
};
constexpr BayerPattern kBayerPatterns[] = {
    {"bayer_rggb8", 0, 0}, {"bayer_grbg8", 1, 0}, {"bayer_gbrg8", 0, 1}, {"bayer_bggr8", 1, 1}};

// Position of the first brightness in each pair of pixels; u and v are the other two.
struct YuvLayout {
  std::string_view encoding;
  std::size_t y, u, v;
};
constexpr YuvLayout kYuvLayouts[] = {
    {"yuv422", 1, 0, 2}, {"uyvy", 1, 0, 2}, {"yuv422_yuy2", 0, 1, 3}, {"yuyv", 0, 1, 3}};

// Returns nullptr for an encoding that is not in the table.
template <typename Entry, std::size_t kCount>
const Entry* find_encoding(const Entry (&table)[kCount], std::string_view encoding) {
  for (const Entry& entry : table)
    if (entry.encoding == encoding) return &entry;
  return nullptr;
}

Status unknown_encoding(const ImageMessage& image, const char* known) {
  return {StatusCode::kUnsupported,
          fmt::format("the encoding '{}' is not read there; {} is", image.encoding.substr(0, 40), known)};
}

std::uint16_t whole_units(float metres) {
  const double units = static_cast<double>(metres) * kFloatDepthUnitsPerMetre + 0.5;
  return units >= 1 && units < 65536 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

const unsigned char* row_of(const ImageMessage& image, int y) {
  return image.data.data() + static_cast<std::size_t>(y) * image.step;
}

void copy_colour(const ImageMessage& image, const ColourLayout& layout, std::uint8_t* out) {
  for (int y = 0; y < image.height; ++y) {
    const unsigned char* in = row_of(image, y);
    for (int x = 0; x < image.width; ++x, in += layout.bytes) {
      *out++ = in[layout.red];
      *out++ = in[layout.green];
      *out++ = in[layout.blue];
    }
  }
}

// Each missing colour is the mean of the nearest pixels that have it: two or four.
void interpolate_bayer(const ImageMessage& image, const BayerPattern& pattern, std::uint8_t* out) {
  // Beyond the border the image is mirrored, which keeps the pattern.
  const auto mirrored = [](int i, int size) {
    const int back = i < 0 ? -i : (i >= size ? 2 * size - 2 - i : i);
    return std::clamp(back, 0, size - 1);
  };
  for (int y = 0; y < image.height; ++y) {
    const unsigned char* rows[3];
    for (int i = 0; i < 3; ++i) rows[i] = row_of(image, mirrored(y + i - 1, image.height));
    for (int x = 0; x < image.width; ++x) {
      const int left = mirrored(x - 1, image.width), right = mirrored(x + 1, image.width);
      const int here = rows[1][x];
      const int beside = rows[1][left] + rows[1][right], above = rows[0][x] + rows[2][x];
      const int corners = rows[0][left] + rows[0][right] + rows[2][left] + rows[2][right];
      const bool red_column = (x & 1) == pattern.red_x, red_row = (y & 1) == pattern.red_y;
      int red = here, green = here, blue = here;
      if (red_column == red_row) {
        green = (beside + above + 2) / 4;
        (red_row ? blue : red) = (corners + 2) / 4;
      } else {
        (red_row ? red : blue) = (beside + 1) / 2;
        (red_row ? blue : red) = (above + 1) / 2;
      }
      *out++ = static_cast<std::uint8_t>(red);
      *out++ = static_cast<std::uint8_t>(green);
      *out++ = static_cast<std::uint8_t>(blue);
    }
  }
}

// BT.601 with brightness from 16 to 235, in units of 2^-20.
void convert_yuv(const ImageMessage& image, const YuvLayout& layout, std::uint8_t* out) {
  constexpr int kShift = 20, kHalf = 1 << (kShift - 1);
  constexpr int kY = 1220542, kRedV = 1673527, kGreenU = -409993, kGreenV = -852492, kBlueU = 2116026;
  const auto byte = [](int value) { return static_cast<std::uint8_t>(std::clamp(value >> kShift, 0, 255)); };
  for (int y = 0; y < image.height; ++y) {
    const unsigned char* row = row_of(image, y);
    for (int x = 0; x < image.width; ++x) {
      // The last pixel of an odd width has u, but no v of its own.
      const unsigned char* pair = row + static_cast<std::size_t>(x / 2) * 4;
      const bool whole = x / 2 * 2 + 1 < image.width;
      const std::size_t place = layout.y + static_cast<std::size_t>(x % 2) * 2;
      const int brightness = kY * std::max(0, pair[place] - 16) + kHalf;
      const int u = whole || layout.u < 2 ? pair[layout.u] - 128 : 0;
      const int v = whole || layout.v < 2 ? pair[layout.v] - 128 : 0;
      *out++ = byte(brightness + kRedV * v);
      *out++ = byte(brightness + kGreenU * u + kGreenV * v);
      *out++ = byte(brightness + kBlueU * u);
    }
  }
}

void copy_depth(const ImageMessage& image, std::uint16_t* out) {
  const bool metres = image.encoding == "32FC1";
  const std::size_t bytes = metres ? 4 : 2;
  for (int y = 0; y < image.height; ++y) {
    const unsigned char* in = row_of(image, y);
    for (int x = 0; x < image.width; ++x, in += bytes) {
      std::uint32_t number = 0;
      for (std::size_t i = 0; i < bytes; ++i)
        number |= static_cast<std::uint32_t>(in[image.big_endian ? bytes - 1 - i : i]) << (8 * i);
      *out++ = metres ? whole_units(std::bit_cast<float>(number)) : static_cast<std::uint16_t>(number);
    }
  }
}

}  // namespace

bool is_colour_encoding(std::string_view encoding) {
  return find_encoding(kColourLayouts, encoding) != nullptr ||
         find_encoding(kBayerPatterns, encoding) != nullptr ||
         find_encoding(kYuvLayouts, encoding) != nullptr;
}

bool is_depth_encoding(std::string_view encoding) {
  return encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1";
}

bool is_grey_encoding(std::string_view encoding) { return encoding == "mono8" || encoding == "mono16"; }

std::size_t bytes_of_pixel(std::string_view encoding) {
  if (const ColourLayout* layout = find_encoding(kColourLayouts, encoding)) return layout->bytes;
  if (find_encoding(kBayerPatterns, encoding) != nullptr) return 1;
  if (encoding == "32FC1") return 4;
  return is_depth_encoding(encoding) || find_encoding(kYuvLayouts, encoding) != nullptr ? 2 : 0;
}

Status ImageConversion::parse(std::string_view type, WireFormat wire, std::span<const unsigned char> bytes,
                              ImageMessage& image) {
  if (type == kImageType) return parse_image(wire, bytes, image);
  const Status status = parse_compressed_image(wire, bytes, image);
  return status.ok() ? parse_file(image) : status;
}

Status ImageConversion::parse_file(ImageMessage& image) {
  ImageInfo info;
  if (Status status = decoder_.read_header(image.data, info); !status.ok()) return status;
  image.width = info.width;
  image.height = info.height;
  const bool depth = info.grey && info.bits == 16;
  if (image.content == Content::kDepthFile) {
    if (depth && is_depth_encoding(image.encoding)) return {};
    return {StatusCode::kUnsupported,
            fmt::format(
                "compressedDepth of '{}' with {} bits is not read; 16UC1 and 32FC1 as grey PNG of 16 bits "
                "are",
                image.encoding.substr(0, 40), info.bits)};
  }
  // The format may name the encoding that the image had before: only the file is certain.
  if (depth)
    image.encoding = image.encoding == "mono16" ? "mono16" : "16UC1";
  else
    image.encoding = info.grey ? "mono8" : "rgb8";
  return {};
}

Status ImageConversion::colour(const ImageMessage& image, std::span<std::uint8_t> rgb) {
  if (!is_colour_encoding(image.encoding)) return unknown_encoding(image, kColourEncodings);
  if (image.content != Content::kPixels)
    return decoder_.decode_rgb(image.data, image.width, image.height, rgb);
  if (const ColourLayout* layout = find_encoding(kColourLayouts, image.encoding))
    copy_colour(image, *layout, rgb.data());
  else if (const BayerPattern* pattern = find_encoding(kBayerPatterns, image.encoding))
    interpolate_bayer(image, *pattern, rgb.data());
  else
    convert_yuv(image, *find_encoding(kYuvLayouts, image.encoding), rgb.data());
  return {};
}

Status ImageConversion::depth(const ImageMessage& image, std::span<std::uint16_t> depth) {
  if (!is_depth_encoding(image.encoding)) return unknown_encoding(image, kDepthEncodings);
  if (image.content == Content::kPixels) {
    copy_depth(image, depth.data());
    return {};
  }
  Status status = decoder_.decode_depth(image.data, image.width, image.height, depth);
  if (status.ok() && image.encoding == "32FC1")
    for (std::uint16_t& value : depth)
      value = value == 0 ? value : whole_units(image.depth_a / (static_cast<float>(value) - image.depth_b));
  return status;
}

}  // namespace plvo
