// SPDX-License-Identifier: Apache-2.0
// Reads numbers and strings of messages and containers in two formats.
//   ROS 1  little-endian, without gaps; the length stands before each string. Bags and MCAP records, too.
//   CDR    of ROS 2 (OMG's Common Data Representation): four bytes state the byte order; after them
//          each number begins at a multiple of its size; strings end with a zero byte that their length
//          includes.
// A read beyond the end returns zero or an empty string, and ok() is false from then on.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace plvo {

enum class WireFormat : std::uint8_t { kRos1, kCdr };

class WireReader {
 public:
  explicit WireReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  // For a message, of which CDR has four bytes in front. An unknown representation is not ok().
  WireReader(WireFormat wire, std::span<const unsigned char> bytes) : bytes_(bytes), wire_(wire) {
    if (wire == WireFormat::kRos1) return;
    const std::span<const unsigned char> start = take(4);
    if (!ok_) return;
    // 0 and 1 are CDR, 6 and 7 CDR of version 2, which aligns to at most four bytes.
    const int representation = start[0] << 8 | start[1];
    ok_ = representation == 0 || representation == 1 || representation == 6 || representation == 7;
    big_endian_ = representation % 2 == 0;
    most_alignment_ = representation < 2 ? 8 : 4;
    read_ = 0;
  }

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }

  std::span<const unsigned char> take(std::size_t count) {
    if (count > bytes_.size()) ok_ = false;
    if (!ok_) return {};
    const std::span<const unsigned char> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    read_ += count;
    return taken;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(number(8)); }
  void skip_f64(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) f64();
  }
  std::string_view text(std::size_t count) {
    const std::span<const unsigned char> taken = take(count);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }
  std::string_view text() {
    std::string_view whole = text(u32());
    if (wire_ == WireFormat::kCdr && whole.ends_with('\0')) whole.remove_suffix(1);
    return whole;
  }
  // Reads seconds and nanoseconds. ROS 2's seconds have a sign.
  std::int64_t time_ns() {
    const std::uint32_t whole = u32();
    const std::int64_t seconds =
        wire_ == WireFormat::kCdr ? std::int64_t{static_cast<std::int32_t>(whole)} : std::int64_t{whole};
    return 1'000'000'000 * seconds + u32();
  }

 private:
  std::uint64_t number(std::size_t bytes) {
    if (wire_ == WireFormat::kCdr) {
      const std::size_t alignment = std::min(bytes, most_alignment_);
      take((alignment - read_ % alignment) % alignment);
    }
    const std::span<const unsigned char> taken = take(bytes);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i)
      value |= static_cast<std::uint64_t>(taken[big_endian_ ? taken.size() - 1 - i : i]) << (8 * i);
    return value;
  }

  std::span<const unsigned char> bytes_;
  WireFormat wire_ = WireFormat::kRos1;
  bool big_endian_ = false;
  std::size_t most_alignment_ = 1;
  std::size_t read_ = 0;  // bytes since the beginning, where alignment is counted from
  bool ok_ = true;
};

}  // namespace plvo
