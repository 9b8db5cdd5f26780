// SPDX-License-Identifier: Apache-2.0
// Converts the pixels of an image message to plvo's formats: colour as RGB, depth in whole units.
//   colour  rgb8 and the like; a Bayer pattern of 8 bits, interpolated linearly;
//           yuv422 (UYVY or YUYV; BT.601); PNG and JPEG.
//           8UC3 does not define its channels: they are taken as BGR, as in OpenCV.
//   depth   16UC1 is millimetres, 32FC1 metres (REP 118); mono16 is 16UC1, as librealsense writes it;
//           a grey PNG of 16 bits; the PNG of the transport compressedDepth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {

inline constexpr const char* kColourEncodings =
    "rgb8, bgr8, rgba8, bgra8, 8UC3, mono8, bayer_…8, yuv422, or compressed";
inline constexpr const char* kDepthEncodings = "16UC1, mono16 or 32FC1";
bool is_colour_encoding(std::string_view encoding);
bool is_depth_encoding(std::string_view encoding);
// Whether the pixels are grey: colour that may be infrared, and depth that may be.
bool is_grey_encoding(std::string_view encoding);
// Returns 0 for an encoding that is not read.
std::size_t bytes_of_pixel(std::string_view encoding);

// Factor from metres to whole units, as in TUM's own PNGs of the same recordings.
inline constexpr double kFloatDepthUnitsPerMetre = kTumDepthUnitsPerMetre;

class ImageConversion {
 public:
  // Parses a message of one of the two types of images. For a compressed one, width, height and encoding come
  // from the header of the file in it. Returns the errors of parse_image, parse_compressed_image and
  // ImageDecoder::read_header.
  Status parse(std::string_view type, WireFormat wire, std::span<const unsigned char> bytes,
               ImageMessage& image);

  // rgb: width·height·3. Returns kUnsupported, naming the encoding, if it is not of colour; kDamaged.
  Status colour(const ImageMessage& image, std::span<std::uint8_t> rgb);
  // depth: width·height. Values in metres that are not a number, not positive or beyond 16 bits become 0, no
  // depth.
  Status depth(const ImageMessage& image, std::span<std::uint16_t> depth);

 private:
  Status parse_file(ImageMessage& image);

  ImageDecoder decoder_;
};

}  // namespace plvo
