// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/messages.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "plvo/camera/camera_info.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/rosbag/wire_reader.hpp"

namespace plvo {
namespace {

constexpr const char* kCutOff = "the message ends early";

std::int64_t take_header(WireReader& wire) {
  wire.u32();  // a counter
  const std::int64_t stamp_ns = wire.time_ns();
  wire.text();  // the name of the frame
  return stamp_ns;
}

// Layout of a pixel in memory: positions of red, green and blue.
struct ColourLayout {
  std::string_view encoding;
  std::size_t bytes, red, green, blue;
};
constexpr ColourLayout kColourLayouts[] = {{"rgb8", 3, 0, 1, 2},  {"bgr8", 3, 2, 1, 0},
                                           {"rgba8", 4, 0, 1, 2}, {"bgra8", 4, 2, 1, 0},
                                           {"8UC3", 3, 2, 1, 0},  {"mono8", 1, 0, 0, 0}};

// Returns nullptr for an encoding that is not of colour.
const ColourLayout* colour_layout(std::string_view encoding) {
  for (const ColourLayout& layout : kColourLayouts)
    if (layout.encoding == encoding) return &layout;
  return nullptr;
}

// Returns 0 for an encoding that is not supported.
std::size_t pixel_bytes(std::string_view encoding) {
  if (const ColourLayout* layout = colour_layout(encoding)) return layout->bytes;
  if (encoding == "16UC1" || encoding == "mono16") return 2;
  return encoding == "32FC1" ? 4 : 0;
}

Status unknown_encoding(const ImageMessage& image, const char* known) {
  return {StatusCode::kUnsupported,
          fmt::format("the encoding '{}' is not read there; {} is", image.encoding.substr(0, 40), known)};
}

std::uint16_t whole_units(float metres) {
  const double units = static_cast<double>(metres) * kFloatDepthUnitsPerMetre + 0.5;
  return units >= 1 && units < 65536 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

}  // namespace

bool is_colour_encoding(std::string_view encoding) { return colour_layout(encoding) != nullptr; }

bool is_depth_encoding(std::string_view encoding) {
  return pixel_bytes(encoding) != 0 && !is_colour_encoding(encoding);
}

Status parse_image(std::span<const unsigned char> bytes, ImageMessage& image) {
  WireReader wire(bytes);
  image.stamp_ns = take_header(wire);
  const std::uint32_t height = wire.u32(), width = wire.u32();
  image.encoding = wire.text();
  image.big_endian = wire.u8() != 0;
  image.step = wire.u32();
  image.data = wire.take(wire.u32());
  if (!wire.ok()) return {StatusCode::kDamaged, kCutOff};
  constexpr std::uint32_t kMost = kMaxImageSide;
  if (width < 1 || height < 1 || width > kMost || height > kMost)
    return {StatusCode::kInvalidArgument,
            fmt::format("an image of {}x{}; at most {}x{} are read", width, height, kMost, kMost)};
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  const std::uint64_t row = std::uint64_t{width} * pixel_bytes(image.encoding);
  if (image.step < row || image.data.size() < std::uint64_t{image.step} * (height - 1) + row)
    return {StatusCode::kDamaged, fmt::format("an image of {}x{} has {} bytes in rows of {}: too few", width,
                                              height, image.data.size(), image.step)};
  return {};
}

Status parse_camera_info(std::span<const unsigned char> bytes, Calibration& calibration) {
  WireReader wire(bytes);
  take_header(wire);
  const std::uint32_t height = wire.u32(), width = wire.u32();
  const std::string_view model = wire.text();
  const std::uint32_t count = wire.u32();
  if (count > wire.left() / sizeof(double)) return {StatusCode::kDamaged, kCutOff};
  std::vector<double> coefficients(count);
  for (double& coefficient : coefficients) coefficient = wire.f64();
  double K[9];
  for (double& entry : K) entry = wire.f64();
  if (!wire.ok()) return {StatusCode::kDamaged, kCutOff};
  constexpr std::uint32_t kMost = kMaxImageSide;
  Calibration found;
  if (width >= 1 && height >= 1 && width <= kMost && height <= kMost) {
    found.camera.width = static_cast<int>(width);
    found.camera.height = static_cast<int>(height);
    found.has_size = true;
  }
  found.camera.pinhole = {K[0], K[4], K[2], K[5]};
  if (!(K[0] > 0 && K[4] > 0))
    return {StatusCode::kInvalidArgument, "K holds no focal length: the camera was not calibrated"};
  if (Status status = distortion_of(model, coefficients, found.camera.distortion); !status.ok())
    return status;
  calibration = found;
  return {};
}

Status parse_imu(std::span<const unsigned char> bytes, ImuMessage& imu) {
  WireReader wire(bytes);
  ImuMessage found;
  found.stamp_ns = take_header(wire);
  constexpr std::size_t kOrientation = 4 + 9, kRestOfCovariance = 8;
  wire.take(kOrientation * sizeof(double));
  for (std::optional<Vector3>* reading : {&found.rate, &found.force}) {
    const double x = wire.f64(), y = wire.f64(), z = wire.f64();
    if (wire.f64() != -1) *reading = Vector3(x, y, z);
    wire.take(kRestOfCovariance * sizeof(double));
  }
  if (!wire.ok()) return {StatusCode::kDamaged, kCutOff};
  imu = found;
  return {};
}

Status colour_pixels(const ImageMessage& image, std::span<std::uint8_t> rgb) {
  const ColourLayout* layout = colour_layout(image.encoding);
  if (layout == nullptr) return unknown_encoding(image, kColourEncodings);
  std::uint8_t* out = rgb.data();
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    const unsigned char* in = image.data.data() + y * image.step;
    for (int x = 0; x < image.width; ++x, in += layout->bytes) {
      *out++ = in[layout->red];
      *out++ = in[layout->green];
      *out++ = in[layout->blue];
    }
  }
  return {};
}

Status depth_pixels(const ImageMessage& image, std::span<std::uint16_t> depth) {
  if (!is_depth_encoding(image.encoding)) return unknown_encoding(image, kDepthEncodings);
  const bool metres = image.encoding == "32FC1";
  const std::size_t bytes = metres ? 4 : 2;
  auto out = depth.begin();
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    const unsigned char* in = image.data.data() + y * image.step;
    for (int x = 0; x < image.width; ++x, in += bytes) {
      std::uint32_t number = 0;
      for (std::size_t i = 0; i < bytes; ++i)
        number |= static_cast<std::uint32_t>(in[image.big_endian ? bytes - 1 - i : i]) << (8 * i);
      *out++ = metres ? whole_units(std::bit_cast<float>(number)) : static_cast<std::uint16_t>(number);
    }
  }
  return {};
}

}  // namespace plvo
