// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/mcap_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace plvo {
namespace {

constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kVersionByte = 5;
constexpr std::size_t kRecordStart = 1 + 8;           // the kind and the length
constexpr std::size_t kMessageStart = 2 + 4 + 8 + 8;  // channel, number, two stamps
constexpr std::size_t kChunkStart = 8 + 8 + 8 + 4;    // two stamps, the unpacked size, a checksum
constexpr std::size_t kLongestCompressionName = 16, kLongestEncodingName = 40;
constexpr std::size_t kMostOfDescription = 4096;  // read of a schema or a channel: the names stand in front

enum Opcode : std::uint8_t {
  kNothing = 0,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunkRecord = 6,
  kDataEnd = 15
};

}  // namespace

Status McapFile::check_beginning() {
  std::array<unsigned char, kMagic.size()> start{};
  if (read_file(0, start) && start == kMagic) return {};
  const bool other = std::equal(start.begin(), start.begin() + kVersionByte, kMagic.begin());
  if (other)
    return {StatusCode::kUnsupported,
            fmt::format("{} is MCAP of another version than 0, which is not read", path().string())};
  return {StatusCode::kDamaged, fmt::format("{} is not an MCAP file", path().string())};
}

Status McapFile::scan(const Take& take) {
  const Status status = ChunkedFile::scan(take);
  if (!status.ok() || !topics().empty() || other_encoding_.empty()) return status;
  set_remark(fmt::format("{}{}messages in the encoding '{}' are not read; those in cdr and ros1 are",
                         remark(), remark().empty() ? "" : "; ", other_encoding_));
  return status;
}

std::uint64_t McapFile::first_record() const { return kMagic.size(); }

ChunkedFile::End McapFile::scan_records(Source& source, std::uint64_t begin, std::uint64_t end,
                                        const bool* whole_chunk) {
  const bool in_chunk = whole_chunk != nullptr;
  if (!in_chunk) {
    closed_ = false;
    schemas_.clear();
    channels_.clear();
    other_encoding_.clear();
  }
  for (std::uint64_t position = begin; position < end;) {
    if (source.unpacked == nullptr) stopped_at_ = position;
    std::array<unsigned char, kRecordStart> start{};
    if (end - position < start.size() || !source.read(position, start)) return End::kCut;
    WireReader reader(start);
    Record record;
    record.op = reader.u8();
    record.bytes = reader.u64();
    record.data = position + start.size();
    record.whole = record.bytes <= end - record.data;
    if (record.op == kNothing) return End::kBroken;
    if (!in_chunk && (record.op == kDataEnd || record.op == kFooter)) {
      closed_ = true;  // what follows repeats and summarises
      return End::kWhole;
    }
    if (record.op == kChunkRecord && in_chunk) {
      failure_ = {StatusCode::kDamaged,
                  fmt::format("{}: at byte {} a chunk lies within another, which no recorder writes",
                              path().string(), stopped_at_)};
    } else if (record.op == kChunkRecord) {
      const End inner = scan_inner(source, record);
      if (inner == End::kBroken) ++broken_chunks_;
    } else if (record.whole) {
      take_record(source, record);
    }
    if (!failure_.ok()) return End::kBroken;
    if (!record.whole) return End::kCut;
    position = record.data + record.bytes;
  }
  return End::kWhole;
}

bool McapFile::read_start(Source& source, const Record& record, std::size_t most) {
  start_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(record.bytes, most)));
  return source.read(record.data, start_);
}

ChunkedFile::End McapFile::scan_inner(Source& source, const Record& record) {
  const std::uint64_t there = std::min<std::uint64_t>(record.bytes, file_bytes() - record.data);
  start_.resize(static_cast<std::size_t>(
      std::min<std::uint64_t>(there, kChunkStart + 4 + kLongestCompressionName + 8)));
  if (!source.read(record.data, start_)) return End::kCut;
  WireReader reader(start_);
  reader.u64();
  reader.u64();
  Chunk chunk;
  chunk.unpacked = reader.u64();
  reader.u32();
  const std::string_view compression = reader.text();
  chunk.bytes = reader.u64();
  if (!reader.ok()) return record.whole ? End::kBroken : End::kCut;
  const std::size_t start_bytes = start_.size() - reader.left();
  chunk.position = record.data + start_bytes;
  if (chunk.bytes > record.bytes - start_bytes) return End::kBroken;
  if (!compression_of(compression, chunk.compression)) return End::kBroken;
  return scan_chunk(source, chunk, record.whole);
}

void McapFile::add_schema() {
  WireReader reader(start_);
  const std::uint16_t number = reader.u16();
  const std::string_view name = reader.text();
  if (reader.ok() && name.size() <= kMostTopicName) schemas_.emplace(number, std::string(name));
}

void McapFile::add_channel() {
  WireReader reader(start_);
  const std::uint16_t number = reader.u16(), schema = reader.u16();
  const std::string_view topic = reader.text(), encoding = reader.text();
  if (!reader.ok()) return;
  if (encoding != "cdr" && encoding != "ros1") {
    other_encoding_ = encoding.substr(0, kLongestEncodingName);
    return;
  }
  const auto type = schemas_.find(schema);
  if (type == schemas_.end() || channels_.contains(number)) return;
  const std::size_t found =
      topic_number(topic, type->second, encoding == "cdr" ? WireFormat::kCdr : WireFormat::kRos1);
  if (found != kNoTopic) channels_.emplace(number, found);
}

void McapFile::take_record(Source& source, const Record& record) {
  if (record.op == kSchema && read_start(source, record, kMostOfDescription)) add_schema();
  if (record.op == kChannel && read_start(source, record, kMostOfDescription)) add_channel();
  if (record.op != kMessage || record.bytes < kMessageStart) return;
  if (!read_start(source, record, kMessageStart)) return;
  WireReader reader(start_);
  const auto channel = channels_.find(reader.u16());
  reader.u32();
  const std::uint64_t received_ns = reader.u64();
  if (channel == channels_.end()) return;
  take_message(source, channel->second, static_cast<std::int64_t>(received_ns), record.data + kMessageStart,
               record.bytes - kMessageStart);
}

}  // namespace plvo
