// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/chunk.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
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

}  // namespace

bool compression_of(std::string_view name, BagCompression& compression) {
  if (name != "none" && name != "bz2" && name != "lz4") return false;
  compression =
      name == "none" ? BagCompression::kNone : (name == "bz2" ? BagCompression::kBz2 : BagCompression::kLz4);
  return true;
}

Status unpack_chunk(BagCompression compression, std::span<const unsigned char> packed,
                    std::span<unsigned char> unpacked) {
  bool good = false;
  if (compression == BagCompression::kNone) {
    good = packed.size() == unpacked.size();
    if (good) std::copy(packed.begin(), packed.end(), unpacked.begin());
  } else {
    good = compression == BagCompression::kBz2 ? unpack_bz2(packed, unpacked) : unpack_lz4(packed, unpacked);
  }
  return good ? Status() : Status(StatusCode::kDamaged, "a compressed piece is damaged");
}

}  // namespace plvo
