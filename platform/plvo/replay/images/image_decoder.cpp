// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/images/image_decoder.hpp"

#include <fmt/core.h>
#include <spng.h>
#include <turbojpeg.h>

#include <memory>

#include "plvo/host/files/input_file.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using PngContext = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

// Bounds on the texts and colour profiles of a PNG, which may unpack to any size and are not used.
constexpr std::size_t kMaxChunk = 1u << 20;
constexpr std::size_t kMaxChunks = 4u << 20;  // together

Status image_error(StatusCode code, const fs::path& path, std::string_view what) {
  return {code, fmt::format("{}: {}", (path.parent_path().filename() / path.filename()).string(), what)};
}

// Messages of the functions below do not name the file.
Status with_name(const fs::path& path, const Status& status) {
  return status.ok() ? status : image_error(status.code(), path, status.message());
}

Status wrong_size(const ImageInfo& info, int width, int height) {
  return {StatusCode::kInvalidArgument,
          fmt::format("is {}x{} where {}x{} is expected; colour and depth must have one size throughout",
                      info.width, info.height, width, height)};
}

Status check_size(const ImageInfo& info) {
  if (info.width >= 1 && info.height >= 1 && info.width <= kMaxImageSide && info.height <= kMaxImageSide)
    return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("says that it is {}x{}; images of at most {}x{} are read (make the images smaller, "
                      "and the calibration with them)",
                      info.width, info.height, kMaxImageSide, kMaxImageSide)};
}

PngContext open_png(std::span<const unsigned char> file) {
  PngContext png(spng_ctx_new(0), spng_ctx_free);
  if (png != nullptr) {
    // The size is judged by check_size, which gives a readable message.
    spng_set_chunk_limits(png.get(), kMaxChunk, kMaxChunks);
    spng_set_png_buffer(png.get(), file.data(), file.size());
  }
  return png;
}

Status png_header(spng_ctx* png, ImageInfo& info) {
  spng_ihdr header{};
  if (const int error = spng_get_ihdr(png, &header); error != 0)
    return {StatusCode::kDamaged,
            fmt::format("not a readable PNG, JPEG, PGM or PPM image ({})", spng_strerror(error))};
  info = {static_cast<int>(header.width), static_cast<int>(header.height), header.bit_depth,
          header.color_type == SPNG_COLOR_TYPE_GRAYSCALE};
  return check_size(info);
}

Status png_pixels(spng_ctx* png, void* pixels, std::size_t bytes, int format) {
  int error = spng_decode_image(png, pixels, bytes, format, 0);
  // Reads to the end: only then is the checksum of the last part of the image compared.
  if (error == 0) error = spng_decode_chunks(png);
  if (error == 0) return {};
  return {StatusCode::kDamaged, fmt::format("damaged or cut off ({})", spng_strerror(error))};
}

Status netpbm_size(std::span<const unsigned char> file, NetpbmHeader& header, ImageInfo& info) {
  if (Status status = read_netpbm_header(file, header); !status.ok()) return status;
  info = {header.width, header.height, header.most > 255 ? 16 : 8, header.grey};
  return check_size(info);
}

bool is_jpeg(std::span<const unsigned char> file) {
  return file.size() > 2 && file[0] == 0xff && file[1] == 0xd8;
}

}  // namespace

Status ImageInfo::check_is_depth() const {
  if (bits == 16 && grey) return {};
  return {
      StatusCode::kInvalidArgument,
      fmt::format("depth has {} bits per channel{}; depth must be a 16-bit grey PNG or PGM (export it again "
                  "without converting to 8 bits or to colour)",
                  bits, grey ? "" : " and colour")};
}

Status ImageInfo::check_is_depth(const fs::path& path) const { return with_name(path, check_is_depth()); }

ImageDecoder::~ImageDecoder() {
  if (jpeg_ != nullptr) tjDestroy(jpeg_);
}

Status ImageDecoder::load(const fs::path& path) {
  const Status status = read_input_file(path, kMaxImageBytes, file_);
  if (status.code() == StatusCode::kNotFound) return image_error(StatusCode::kNotFound, path, "is not there");
  return status;
}

Status ImageDecoder::jpeg_header(std::span<const unsigned char> file, ImageInfo& info) {
  if (jpeg_ == nullptr) jpeg_ = tjInitDecompress();
  int subsampling = 0;
  int colour_space = 0;
  if (tjDecompressHeader3(jpeg_, file.data(), file.size(), &info.width, &info.height, &subsampling,
                          &colour_space) != 0)
    return {StatusCode::kDamaged, fmt::format("damaged JPEG ({})", tjGetErrorStr2(jpeg_))};
  info.bits = 8;
  info.grey = colour_space == TJCS_GRAY;
  return check_size(info);
}

Status ImageDecoder::read_header(std::span<const unsigned char> file, ImageInfo& info) {
  if (NetpbmHeader header; is_netpbm(file)) return netpbm_size(file, header, info);
  if (is_jpeg(file)) return jpeg_header(file, info);
  return png_header(open_png(file).get(), info);
}

Status ImageDecoder::decode_rgb(std::span<const unsigned char> file, int width, int height,
                                std::span<std::uint8_t> rgb) {
  ImageInfo info;
  NetpbmHeader header;
  const bool jpeg = is_jpeg(file);
  const bool netpbm = is_netpbm(file);
  const PngContext png = open_png(file);
  if (Status status = jpeg     ? jpeg_header(file, info)
                      : netpbm ? netpbm_size(file, header, info)
                               : png_header(png.get(), info);
      !status.ok())
    return status;
  if (info.width != width || info.height != height) return wrong_size(info, width, height);
  if (netpbm) return read_netpbm_rgb(file, header, rgb);
  if (!jpeg) return png_pixels(png.get(), rgb.data(), rgb.size(), SPNG_FMT_RGB8);
  // TurboJPEG decodes a JPEG that ends early to grey bars with a mere warning: here it counts as damaged. A
  // progressive JPEG may contain any number of scans: here at most 500.
  if (tjDecompress2(jpeg_, file.data(), file.size(), rgb.data(), width, 0, height, TJPF_RGB,
                    TJFLAG_LIMITSCANS) != 0)
    return {StatusCode::kDamaged, fmt::format("damaged JPEG ({})", tjGetErrorStr2(jpeg_))};
  return {};
}

Status ImageDecoder::decode_depth(std::span<const unsigned char> file, int width, int height,
                                  std::span<std::uint16_t> depth) {
  ImageInfo info;
  NetpbmHeader header;
  const bool netpbm = is_netpbm(file);
  const PngContext png = open_png(file);
  Status status = netpbm ? netpbm_size(file, header, info) : png_header(png.get(), info);
  if (status.ok()) status = info.check_is_depth();
  if (!status.ok()) return status;
  if (info.width != width || info.height != height) return wrong_size(info, width, height);
  if (netpbm) return read_netpbm_depth(file, header, depth);
  return png_pixels(png.get(), depth.data(), depth.size_bytes(), SPNG_FMT_PNG);  // 16 bits in host order
}

Status ImageDecoder::read_header(const fs::path& path, ImageInfo& info) {
  const Status status = load(path);
  return status.ok() ? with_name(path, read_header(file_, info)) : status;
}

Status ImageDecoder::decode_rgb(const fs::path& path, int width, int height, std::span<std::uint8_t> rgb) {
  const Status status = load(path);
  return status.ok() ? with_name(path, decode_rgb(file_, width, height, rgb)) : status;
}

Status ImageDecoder::decode_depth(const fs::path& path, int width, int height,
                                  std::span<std::uint16_t> depth) {
  const Status status = load(path);
  return status.ok() ? with_name(path, decode_depth(file_, width, height, depth)) : status;
}

}  // namespace plvo
