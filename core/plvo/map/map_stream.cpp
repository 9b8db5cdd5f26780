// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/map_stream.hpp"

#include <algorithm>
#include <cstring>

namespace plvo {
namespace {

// The checksum of each half of a byte.
constexpr std::array<std::uint32_t, 16> make_crc_table() {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 4; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xedb88320U : crc >> 1;
    table[i] = crc;
  }
  return table;
}
constexpr std::array<std::uint32_t, 16> kCrcTable = make_crc_table();

template <typename To, typename From>
To same_bits(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}

}  // namespace

void Crc32::add(std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) {
    state_ ^= static_cast<std::uint32_t>(byte);
    state_ = state_ >> 4 ^ kCrcTable[state_ & 15];
    state_ = state_ >> 4 ^ kCrcTable[state_ & 15];
  }
}

void MapWriter::flush() {
  const std::span<const std::byte> bytes = std::span(block_).first(size_);
  if (status_.ok() && !bytes.empty()) status_ = sink_.write(bytes);
  size_ = 0;
}

void MapWriter::bytes(std::span<const std::byte> bytes) {
  crc_.add(bytes);
  for (const std::byte byte : bytes) {
    block_[size_++] = byte;
    if (size_ == block_.size()) flush();
  }
}

void MapWriter::whole(std::uint64_t value, std::size_t byte_count) {
  std::array<std::byte, 8> little_endian;
  for (std::size_t i = 0; i < byte_count; ++i) little_endian[i] = static_cast<std::byte>(value >> (8 * i));
  bytes(std::span(little_endian).first(byte_count));
}

void MapWriter::number(double value) { whole(same_bits<std::uint64_t>(value), 8); }
void MapWriter::number(float value) { whole(same_bits<std::uint32_t>(value), 4); }

void MapWriter::pose(const Se3& T) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) number(T.R(r, c));
  for (int i = 0; i < 3; ++i) number(T.t[i]);
}

void MapWriter::matrix(const Matrix6& m) {
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) number(m(r, c));
}

void MapWriter::checksum() {
  whole(crc_.value(), 4);
  crc_ = Crc32();
}

Status MapWriter::finish() {
  flush();
  return status_;
}

void MapReader::bytes(std::span<std::byte> bytes) {
  if (status_.ok()) status_ = source_.read(bytes);
  if (!status_.ok()) std::fill(bytes.begin(), bytes.end(), std::byte{0});
  crc_.add(bytes);
}

std::uint64_t MapReader::whole(std::size_t byte_count) {
  std::array<std::byte, 8> little_endian;
  bytes(std::span(little_endian).first(byte_count));
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < byte_count; ++i)
    value |= static_cast<std::uint64_t>(little_endian[i]) << (8 * i);
  return value;
}

double MapReader::number() { return same_bits<double>(whole(8)); }
float MapReader::number_of_32_bits() { return same_bits<float>(whole32()); }

Se3 MapReader::pose() {
  Se3 T;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) T.R(r, c) = number();
  for (int i = 0; i < 3; ++i) T.t[i] = number();
  return T;
}

Matrix6 MapReader::matrix() {
  Matrix6 m;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) m(r, c) = number();
  return m;
}

bool MapReader::checksum() {
  const std::uint32_t computed = crc_.value();
  const bool same = whole32() == computed;
  crc_ = Crc32();
  return same && status_.ok();
}

}  // namespace plvo
