// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/chunk.hpp"

#include <bzlib.h>
#include <fmt/core.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>

namespace plvo {
namespace {

bool unpack_bz2(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) {
  // The interface of the library is older than const; it does not write to its input.
  auto* from = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  auto written = static_cast<unsigned int>(unpacked.size());
  const int error = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(unpacked.data()), &written, from,
                                               static_cast<unsigned int>(packed.size()), 0, 0);
  return error == BZ_OK && written == unpacked.size();
}

bool unpack_lz4(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) return false;
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(made,
                                                                             LZ4F_freeDecompressionContext);
  while (!packed.empty()) {
    std::size_t written = unpacked.size(), read = packed.size();
    const std::size_t more =
        LZ4F_decompress(context.get(), unpacked.data(), &written, packed.data(), &read, nullptr);
    if (LZ4F_isError(more) || (read == 0 && written == 0)) return false;
    unpacked = unpacked.subspan(written);
    packed = packed.subspan(read);
    if (more == 0) return unpacked.empty();
  }
  return false;
}

bool unpack_zstd(std::span<const unsigned char> packed, std::span<unsigned char> unpacked) {
  return ZSTD_decompress(unpacked.data(), unpacked.size(), packed.data(), packed.size()) == unpacked.size();
}

using ZstdStream = std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)>;

// The window, which a file states, is memory: 8 MiB suffice for every level of the recorders.
ZstdStream zstd_stream() {
  constexpr int kLargestWindow_log2 = 23;
  ZstdStream stream(ZSTD_createDStream(), ZSTD_freeDStream);
  if (stream != nullptr) ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, kLargestWindow_log2);
  return stream;
}

Status damaged_piece() { return {StatusCode::kDamaged, "a compressed piece is damaged"}; }

}  // namespace

bool compression_of(std::string_view name, Compression& compression) {
  constexpr std::pair<std::string_view, Compression> kNames[] = {{"", Compression::kNone},
                                                                 {"none", Compression::kNone},
                                                                 {"bz2", Compression::kBz2},
                                                                 {"lz4", Compression::kLz4},
                                                                 {"zstd", Compression::kZstd}};
  for (const auto& [known, value] : kNames)
    if (name == known) {
      compression = value;
      return true;
    }
  return false;
}

Status unpack_chunk(Compression compression, std::span<const unsigned char> packed,
                    std::span<unsigned char> unpacked) {
  bool good = false;
  switch (compression) {
    case Compression::kNone:
      good = packed.size() == unpacked.size();
      if (good) std::copy(packed.begin(), packed.end(), unpacked.begin());
      break;
    case Compression::kBz2: good = unpack_bz2(packed, unpacked); break;
    case Compression::kLz4: good = unpack_lz4(packed, unpacked); break;
    case Compression::kZstd: good = unpack_zstd(packed, unpacked); break;
  }
  return good ? Status() : damaged_piece();
}

bool is_zstd(std::span<const unsigned char> bytes) {
  constexpr std::array<unsigned char, 4> kMagic = {0x28, 0xb5, 0x2f, 0xfd};
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

Status unpack_zstd_message(std::span<const unsigned char> packed, std::size_t most,
                           std::vector<unsigned char>& unpacked) {
  // The recorder compresses a message in one call, so its frame states the size.
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  unpacked.clear();
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR || size > most)
    return damaged_piece();
  if (unpacked.capacity() < size) std::vector<unsigned char>().swap(unpacked);
  unpacked.resize(static_cast<std::size_t>(size));
  return unpack_zstd(packed, unpacked) ? Status() : damaged_piece();
}

Status unpack_zstd_start(std::span<const unsigned char> packed, std::span<unsigned char> start) {
  const ZstdStream stream = zstd_stream();
  if (stream == nullptr) return {StatusCode::kOutOfMemory, "not enough memory to unpack"};
  ZSTD_inBuffer in = {packed.data(), packed.size(), 0};
  ZSTD_outBuffer out = {start.data(), start.size(), 0};
  while (out.pos < out.size) {
    const std::size_t before = out.pos, taken = in.pos;
    if (ZSTD_isError(ZSTD_decompressStream(stream.get(), &out, &in))) return damaged_piece();
    if (out.pos == before && in.pos == taken) return damaged_piece();
  }
  return {};
}

Status unpack_zstd_file(const std::filesystem::path& packed, std::uintmax_t most,
                        const std::filesystem::path& unpacked) {
  const ZstdStream stream = zstd_stream();
  if (stream == nullptr) return {StatusCode::kOutOfMemory, "not enough memory to unpack"};
  std::ifstream from(packed, std::ios::binary);
  std::ofstream to(unpacked, std::ios::binary);
  std::vector<char> in_bytes(ZSTD_DStreamInSize()), out_bytes(ZSTD_DStreamOutSize());
  std::uintmax_t written = 0;
  while (from) {
    from.read(in_bytes.data(), static_cast<std::streamsize>(in_bytes.size()));
    ZSTD_inBuffer in = {in_bytes.data(), static_cast<std::size_t>(from.gcount()), 0};
    for (bool full = false; in.pos < in.size || full;) {
      ZSTD_outBuffer out = {out_bytes.data(), out_bytes.size(), 0};
      // A file that is cut off gives what lies before.
      if (ZSTD_isError(ZSTD_decompressStream(stream.get(), &out, &in)))
        return written > 0
                   ? Status()
                   : Status(StatusCode::kDamaged,
                            fmt::format("{} cannot be unpacked: it is damaged, or not compressed by zstd",
                                        packed.string()));
      full = out.pos == out.size;
      written += out.pos;
      if (written > most)
        return {StatusCode::kIo,
                fmt::format("{} unpacks to more than the {} MB that the disk has for it: unpack "
                            "it elsewhere (unzstd)",
                            packed.string(), most / 1'000'000)};
      to.write(out_bytes.data(), static_cast<std::streamsize>(out.pos));
    }
  }
  if (!to.flush()) return {StatusCode::kIo, fmt::format("{} cannot be written", unpacked.string())};
  return {};
}

}  // namespace plvo
