// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/bag_file.hpp"

#include <fmt/core.h>

#include <string>
#include <string_view>
#include <vector>

namespace plvo {

namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
// Largest header of a record; a longer one means damage.
constexpr std::uint32_t kMaxHeader = 1u << 16;
constexpr std::uint32_t kMaxConnection = 1u << 22;  // the text of a message's definition
constexpr std::size_t kMostConnections = 10'000;

enum Op : std::uint8_t { kMessageData = 2, kFileHeader = 3, kChunkOp = 5, kConnection = 7 };

// Finds a field among name=value entries, each after its length.
std::string_view field_of(std::span<const unsigned char> fields, std::string_view name) {
  WireReader wire(fields);
  while (wire.left() > 0) {
    const std::string_view field = wire.text();
    if (!wire.ok()) return {};
    if (field.size() > name.size() && field[name.size()] == '=' && field.starts_with(name))
      return field.substr(name.size() + 1);
  }
  return {};
}

std::uint64_t number_of(std::string_view value, std::size_t bytes) {
  if (value.size() != bytes) return 0;
  WireReader wire({reinterpret_cast<const unsigned char*>(value.data()), value.size()});
  return bytes == 8 ? wire.u64() : wire.u32();
}

}  // namespace

struct BagFile::Record {
  std::vector<unsigned char> header;
  std::uint64_t data = 0;  // position
  std::uint32_t data_bytes = 0;
  bool whole = false;  // its data ends within the available bytes

  std::string_view field(std::string_view name) const { return field_of(header, name); }
  std::uint32_t number(std::string_view name) const {
    return static_cast<std::uint32_t>(number_of(field(name), 4));
  }
  // 0: the record has none.
  std::uint8_t op() const {
    const std::string_view value = field("op");
    return value.size() == 1 ? static_cast<std::uint8_t>(value[0]) : std::uint8_t{0};
  }
};

Status BagFile::check_beginning() {
  std::string line(kVersion.size(), '\0');
  const bool read = read_file(0, {reinterpret_cast<unsigned char*>(line.data()), line.size()});
  if (read && line == kVersion) return {};
  if (read && line.starts_with("#ROS"))
    return {
        StatusCode::kUnsupported,
        fmt::format("{} is a bag of another version than 2.0; convert it with rosbag migrate or rosbag fix",
                    path().string())};
  return {StatusCode::kDamaged, fmt::format("{} is not a ROS 1 bag", path().string())};
}

std::uint64_t BagFile::first_record() const { return kVersion.size(); }

BagFile::End BagFile::scan_records(Source& source, std::uint64_t begin, std::uint64_t end,
                                   const bool* whole_chunk) {
  const bool in_chunk = whole_chunk != nullptr;
  if (!in_chunk) connections_.clear();
  Record record;
  for (std::uint64_t position = begin; position < end;) {
    if (source.unpacked == nullptr) stopped_at_ = position;
    if (const End read = read_record(source, position, end, record); read != End::kWhole) return read;
    if (record.op() == kChunkOp && in_chunk) {
      // If either exceeds its end, the length of the outer one is damaged.
      if (source.unpacked == nullptr && !(*whole_chunk && record.whole)) return End::kOverrun;
      failure_ = {StatusCode::kDamaged,
                  fmt::format("{}: at byte {} a chunk lies within another, which no recorder writes; rosbag "
                              "reindex may mend it",
                              path().string(), stopped_at_)};
    } else if (record.op() == kChunkOp) {
      const End inner = scan_inner(source, record);
      if (inner == End::kBroken || inner == End::kOverrun) ++broken_chunks_;
      if (inner == End::kOverrun) {
        position = stopped_at_;
        continue;
      }
    } else if (record.op() == kFileHeader && !in_chunk) {
      index_position_ = number_of(record.field("index_pos"), 8);
    } else {
      take_record(record, source);
    }
    if (!failure_.ok()) return End::kBroken;
    if (!record.whole) return End::kCut;
    position = record.data + record.data_bytes;
  }
  return End::kWhole;
}

BagFile::End BagFile::scan_inner(Source& source, const Record& record) {
  Chunk chunk;
  if (!compression_of(record.field("compression"), chunk.compression)) return End::kBroken;
  chunk.position = record.data;
  chunk.bytes = record.data_bytes;
  chunk.unpacked = record.number("size");
  return scan_chunk(source, chunk, record.whole);
}

BagFile::End BagFile::read_record(Source& source, std::uint64_t position, std::uint64_t end, Record& record) {
  unsigned char length[4];
  if (end - position < sizeof length || !source.read(position, length)) return End::kCut;
  const std::uint32_t header_bytes = WireReader(length).u32();
  position += sizeof length;
  if (header_bytes > kMaxHeader) return End::kBroken;
  if (end - position < header_bytes + sizeof length) return End::kCut;
  record.header.resize(header_bytes);
  if (!source.read(position, record.header) || !source.read(position + header_bytes, length))
    return End::kCut;
  record.data = position + header_bytes + sizeof length;
  record.data_bytes = WireReader(length).u32();
  record.whole = record.data_bytes <= end - record.data;
  return record.op() == 0 ? End::kBroken : End::kWhole;
}

void BagFile::take_record(const Record& record, Source& source) {
  if (!record.whole) return;
  if (record.op() == kConnection && record.data_bytes <= kMaxConnection) {
    std::vector<unsigned char> data(record.data_bytes);
    if (source.read(record.data, data)) add_connection(record, data);
  } else if (record.op() == kMessageData) {
    const auto connection = connections_.find(record.number("conn"));
    if (connection == connections_.end()) return;
    const std::string_view time = record.field("time");
    WireReader reader({reinterpret_cast<const unsigned char*>(time.data()), time.size()});
    take_message(source, connection->second, reader.time_ns(), record.data, record.data_bytes);
  }
}

void BagFile::add_connection(const Record& record, std::span<const unsigned char> data) {
  const std::uint32_t number = record.number("conn");
  if (connections_.contains(number) || connections_.size() >= kMostConnections) return;
  const std::size_t topic = topic_number(record.field("topic"), field_of(data, "type"), WireFormat::kRos1);
  if (topic != kNoTopic) connections_.emplace(number, topic);
}

}  // namespace plvo
