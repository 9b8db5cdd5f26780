// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/image_writer.hpp"

#include <fmt/core.h>
#include <spng.h>
#include <turbojpeg.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

#include "plvo/host/files/whole_write.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

// A recording at 30 Hz has 33 ms for a pair of images. For those of a real Kinect (640x480), level 1 with one
// filter takes 14 ms and 655 kB; level 3 with a filter chosen per row takes 39 ms and 610 kB.
constexpr int kCompressionLevel = 1;
constexpr int kColourFilter = SPNG_FILTER_CHOICE_SUB;
constexpr int kDepthFilter = SPNG_FILTER_CHOICE_NONE;

// Writes rows without gaps, top to bottom, as libspng requires.
Status write_rows(const fs::path& path, spng_ihdr header, std::span<const std::uint8_t> pixels, int filter) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> png(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  if (png == nullptr) return {StatusCode::kOutOfMemory, "no memory to encode a PNG image"};
  spng_set_option(png.get(), SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(png.get(), SPNG_IMG_COMPRESSION_LEVEL, kCompressionLevel);
  spng_set_option(png.get(), SPNG_FILTER_CHOICE, filter);
  spng_set_ihdr(png.get(), &header);
  int error = spng_encode_image(png.get(), pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
  std::size_t bytes = 0;
  std::unique_ptr<void, void (*)(void*)> file(
      error == 0 ? spng_get_png_buffer(png.get(), &bytes, &error) : nullptr, std::free);
  if (file == nullptr)
    return {StatusCode::kInvalidArgument,
            fmt::format("cannot encode {}: {}", path.string(), spng_strerror(error))};
  FILE* stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr) return output_failed("write", path, errno);
  int reason = std::fwrite(file.get(), 1, bytes, stream) == bytes ? 0 : errno;
  if (std::fclose(stream) != 0 && reason == 0) reason = errno;
  if (reason == 0) return {};
  // Removes an incomplete file: a cut image is useless, and its space is needed. A device is not removed.
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) fs::remove(path, ignored);
  return output_failed("write", path, reason);
}

spng_ihdr make_header(int width, int height, std::uint8_t bits, std::uint8_t colour_type) {
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = bits;
  header.color_type = colour_type;
  return header;
}

}  // namespace

Status write_png(const fs::path& path, const ColourView& image) {
  const bool grey = image.format == PixelFormat::kGray8;
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * (grey ? 1 : 3);
  std::vector<std::uint8_t> pixels(row_bytes * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* row = pixels.data() + static_cast<std::size_t>(y) * row_bytes;
    std::memcpy(row, image.data + y * image.stride_bytes, row_bytes);
    if (image.format != PixelFormat::kBgr8) continue;
    for (std::size_t i = 0; i < row_bytes; i += 3) std::swap(row[i], row[i + 2]);
  }
  const auto colour_type = grey ? SPNG_COLOR_TYPE_GRAYSCALE : SPNG_COLOR_TYPE_TRUECOLOR;
  return write_rows(path, make_header(image.width, image.height, 8, colour_type), pixels, kColourFilter);
}

Status write_png(const fs::path& path, const DepthView& image) {
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * sizeof(std::uint16_t);
  std::vector<std::uint8_t> pixels(row_bytes * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    std::memcpy(pixels.data() + static_cast<std::size_t>(y) * row_bytes, image.data + y * image.stride,
                row_bytes);
  return write_rows(path, make_header(image.width, image.height, 16, SPNG_COLOR_TYPE_GRAYSCALE), pixels,
                    kDepthFilter);
}

std::vector<std::uint8_t> encode_jpeg(const ColourView& image, int quality) {
  if (image.data == nullptr || image.width <= 0 || image.height <= 0) return {};
  const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitCompress(), tjDestroy);
  const int format = image.format == PixelFormat::kGray8  ? TJPF_GRAY
                     : image.format == PixelFormat::kRgb8 ? TJPF_RGB
                                                          : TJPF_BGR;
  const int subsampling = image.format == PixelFormat::kGray8 ? TJSAMP_GRAY : TJSAMP_420;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  std::vector<std::uint8_t> result;
  if (tjCompress2(handle.get(), image.data, image.width, static_cast<int>(image.stride_bytes), image.height,
                  format, &bytes, &size, subsampling, quality, 0) == 0)
    result.assign(bytes, bytes + size);
  tjFree(bytes);
  return result;
}

}  // namespace plvo
