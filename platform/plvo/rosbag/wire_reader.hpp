// SPDX-License-Identifier: Apache-2.0
// Reads numbers and strings in the format of ROS 1 messages and bags: little-endian, with the length before
// each string. A read beyond the end returns zero or an empty string, and ok() is false from then on.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace plvo {

class WireReader {
 public:
  explicit WireReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }

  std::span<const unsigned char> take(std::size_t count) {
    if (count > bytes_.size()) ok_ = false;
    if (!ok_) return {};
    const std::span<const unsigned char> taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  double f64() { return std::bit_cast<double>(number(8)); }
  std::string_view text(std::size_t count) {
    const std::span<const unsigned char> taken = take(count);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }
  std::string_view text() { return text(u32()); }
  // Reads seconds and nanoseconds.
  std::int64_t time_ns() {
    const std::int64_t seconds = u32();
    return 1'000'000'000 * seconds + u32();
  }

 private:
  std::uint64_t number(std::size_t bytes) {
    std::uint64_t value = 0;
    int shift = 0;
    for (const unsigned char byte : take(bytes)) {
      value |= static_cast<std::uint64_t>(byte) << shift;
      shift += 8;
    }
    return value;
  }

  std::span<const unsigned char> bytes_;
  bool ok_ = true;
};

}  // namespace plvo
