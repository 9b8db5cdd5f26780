// SPDX-License-Identifier: Apache-2.0
// Streams for saving and loading a map. The bytes pass in blocks through functions of the caller,
// which write them to a file, a flash memory or a link, or read them from there. Numbers are
// little-endian on every processor; all bytes enter a checksum.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/status.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

class ByteSink {
 public:
  // Takes all bytes.
  virtual Status write(std::span<const std::byte> bytes) = 0;

 protected:
  ~ByteSink() = default;  // never deleted through a base pointer
};

class ByteSource {
 public:
  // Fills all bytes. Not ok() if fewer are left.
  virtual Status read(std::span<std::byte> bytes) = 0;

 protected:
  ~ByteSource() = default;
};

// Both streams over a block of the caller's memory. They are inline because a program with RTTI needs type
// information that the core, built without RTTI, lacks.
class SpanSink final : public ByteSink {
 public:
  explicit SpanSink(std::span<std::byte> memory) : memory_(memory) {}
  Status write(std::span<const std::byte> bytes) override {
    if (bytes.size() > memory_.size() - size_)
      return {StatusCode::kOutOfMemory, "the map takes more bytes than there are: see Map::saved_bytes()"};
    std::copy(bytes.begin(), bytes.end(), memory_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += bytes.size();
    return {};
  }
  std::size_t size() const { return size_; }  // bytes that were written

 private:
  std::span<std::byte> memory_;
  std::size_t size_ = 0;
};

class SpanSource final : public ByteSource {
 public:
  explicit SpanSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  Status read(std::span<std::byte> bytes) override {
    if (bytes.size() > bytes_.size())
      return {StatusCode::kDamaged,
              "the map is cut off: its end is missing; make the map again, or use a copy"};
    std::copy_n(bytes_.begin(), bytes.size(), bytes.begin());
    bytes_ = bytes_.subspan(bytes.size());
    return {};
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

// CRC-32 (IEEE 802.3; that of gzip and PNG).
class Crc32 {
 public:
  void add(std::span<const std::byte> bytes);
  std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xffffffff;
};

// Collects numbers into blocks. After a failure it ignores all numbers.
class MapWriter {
 public:
  explicit MapWriter(ByteSink& sink) : sink_(sink) {}

  void bytes(std::span<const std::byte> bytes);
  void whole(std::uint64_t value, std::size_t byte_count);
  void number(double value);
  void number(float value);
  void pose(const Se3& T);
  void matrix(const Matrix6& m);
  // The checksum of all that was written since the last one.
  void checksum();
  // Writes the last block.
  Status finish();

 private:
  void flush();

  ByteSink& sink_;
  std::array<std::byte, 512> block_;
  std::size_t size_ = 0;
  Crc32 crc_;
  Status status_;
};

// Reads them back. After a failure all numbers are 0.
class MapReader {
 public:
  explicit MapReader(ByteSource& source) : source_(source) {}

  void bytes(std::span<std::byte> bytes);
  std::uint64_t whole(std::size_t byte_count);
  std::uint16_t whole16() { return static_cast<std::uint16_t>(whole(2)); }
  std::uint32_t whole32() { return static_cast<std::uint32_t>(whole(4)); }
  double number();
  float number_of_32_bits();
  Se3 pose();
  Matrix6 matrix();
  // Whether the next bytes are the checksum of all that was read since the last one.
  bool checksum();
  const Status& status() const { return status_; }

 private:
  ByteSource& source_;
  Crc32 crc_;
  Status status_;
};

}  // namespace plvo
