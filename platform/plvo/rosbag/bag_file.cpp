// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "plvo/rosbag/messages.hpp"
#include "plvo/rosbag/wire_reader.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
// Of a record; longer ones are not what they seem.
constexpr std::uint32_t kMaxHeader = 1u << 16;
constexpr std::uint32_t kMaxConnection = 1u << 22;  // the text of a message's definition
constexpr std::uint32_t kMaxUnpacked = 1u << 28;    // what a chunk may become
constexpr std::size_t kMaxTopics = 10'000;

enum Op : std::uint8_t { kMessageData = 2, kFileHeader = 3, kChunkOp = 5, kConnection = 7 };

bool has_stamp(std::string_view type) {
  return type == kImageType || type == kCameraInfoType || type == kImuType;
}

// name=value, each after its length.
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
  bool whole = false;  // its data ends where the bytes do, or before

  std::string_view field(std::string_view name) const { return field_of(header, name); }
  std::uint32_t number(std::string_view name) const {
    return static_cast<std::uint32_t>(number_of(field(name), 4));
  }
  // 0: there is none.
  std::uint8_t op() const {
    const std::string_view value = field("op");
    return value.size() == 1 ? static_cast<std::uint8_t>(value[0]) : std::uint8_t{0};
  }
};

Status BagFile::open(const fs::path& path) {
  *this = BagFile();
  path_ = path;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return {StatusCode::kNotFound, fmt::format("{} is not there", path.string())};
  if (!fs::is_regular_file(status))
    return {StatusCode::kInvalidArgument, fmt::format("{} is not a regular file", path.string())};
  file_bytes_ = fs::file_size(path, error);
  file_.open(path, std::ios::binary);
  if (error || !file_) return {StatusCode::kPermission, fmt::format("{} cannot be read", path.string())};
  if (Status version = check_version(); !version.ok()) return version;
  const End end = scan(
      [this](std::uint64_t position, std::span<unsigned char> bytes) { return read_file(position, bytes); },
      kVersion.size(), file_bytes_, -1);
  remark_on(end, index_position_ != 0 && index_position_ <= file_bytes_);
  return {};
}

bool BagFile::read_file(std::uint64_t position, std::span<unsigned char> bytes) {
  if (position > file_bytes_ || bytes.size() > file_bytes_ - position) return false;
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(file_);
}

Status BagFile::check_version() {
  std::string line(kVersion.size(), '\0');
  const bool read = read_file(0, {reinterpret_cast<unsigned char*>(line.data()), line.size()});
  if (read && line == kVersion) return {};
  if (read && line.starts_with("#ROS"))
    return {
        StatusCode::kUnsupported,
        fmt::format("{} is a bag of another version than 2.0; rosbag migrate or rosbag fix makes one of it",
                    path_.string())};
  return {StatusCode::kDamaged, fmt::format("{} is not a ROS 1 bag (one of ROS 2 is a folder or a .db3 or "
                                            ".mcap file, which are not read)",
                                            path_.string())};
}

BagFile::End BagFile::scan(const ReadAt& read_at, std::uint64_t begin, std::uint64_t end,
                           std::int64_t chunk) {
  Record record;
  for (std::uint64_t position = begin; position < end;) {
    stopped_at_ = chunk < 0 ? position : stopped_at_;
    unsigned char length[4];
    if (end - position < sizeof length || !read_at(position, length)) return End::kCut;
    const std::uint32_t header_bytes = WireReader(length).u32();
    position += sizeof length;
    if (header_bytes > kMaxHeader) return End::kBroken;
    if (end - position < header_bytes + sizeof length) return End::kCut;
    record.header.resize(header_bytes);
    if (!read_at(position, record.header) || !read_at(position + header_bytes, length)) return End::kCut;
    record.data = position + header_bytes + sizeof length;
    record.data_bytes = WireReader(length).u32();
    record.whole = record.data_bytes <= end - record.data;
    const std::uint8_t op = record.op();
    if (op == 0) return End::kBroken;
    if (op == kChunkOp && chunk < 0) {
      if (scan_chunk(record, end) == End::kBroken) ++broken_chunks_;
    } else if (op == kFileHeader && chunk < 0) {
      index_position_ = number_of(record.field("index_pos"), 8);
    } else if (op == kConnection && record.whole && record.data_bytes <= kMaxConnection) {
      std::vector<unsigned char> data(record.data_bytes);
      if (read_at(record.data, data)) add_connection(record, data);
    } else if (op == kMessageData && record.whole) {
      add_message(record, read_at, chunk);
    }
    if (!record.whole) return End::kCut;
    position = record.data + record.data_bytes;
  }
  return End::kWhole;
}

BagFile::End BagFile::scan_chunk(const Record& record, std::uint64_t end) {
  Chunk chunk;
  if (!compression_of(record.field("compression"), chunk.compression)) return End::kBroken;
  const ReadAt from_file = [this](std::uint64_t position, std::span<unsigned char> bytes) {
    return read_file(position, bytes);
  };
  // Of what is not compressed the messages before a cut can be read where they are.
  if (chunk.compression == BagCompression::kNone)
    return scan(from_file, record.data, std::min(end, record.data + record.data_bytes), -1);
  chunk.position = record.data;
  chunk.bytes = record.data_bytes;
  chunk.unpacked = record.number("size");
  if (!record.whole) return End::kCut;
  if (chunk.unpacked > kMaxUnpacked) return End::kBroken;
  const auto number = static_cast<std::int64_t>(chunks_.size());
  chunks_.push_back(chunk);
  const std::vector<unsigned char>* bytes = nullptr;
  if (!unpacked(number, bytes).ok()) return End::kBroken;
  const ReadAt from_chunk = [bytes](std::uint64_t position, std::span<unsigned char> out) {
    if (position > bytes->size() || out.size() > bytes->size() - position) return false;
    std::copy_n(bytes->begin() + static_cast<std::ptrdiff_t>(position), out.size(), out.begin());
    return true;
  };
  return scan(from_chunk, 0, bytes->size(), number) == End::kWhole ? End::kWhole : End::kBroken;
}

void BagFile::add_connection(const Record& record, std::span<const unsigned char> data) {
  const std::uint32_t number = record.number("conn");
  const std::string_view name = record.field("topic"), type = field_of(data, "type");
  if (connections_.contains(number) || name.empty() || connections_.size() >= kMaxTopics) return;
  const auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
    return other.name == name && other.type == type;
  });
  connections_.emplace(number, static_cast<std::size_t>(topic - topics_.begin()));
  if (topic == topics_.end()) topics_.push_back({std::string(name), std::string(type), 0});
}

void BagFile::add_message(const Record& record, const ReadAt& read_at, std::int64_t chunk) {
  const auto connection = connections_.find(record.number("conn"));
  if (connection == connections_.end()) return;
  BagTopic& topic = topics_[connection->second];
  ++topic.messages;
  unsigned char start[12];  // of the message's header: a count, then the stamp
  if (!has_stamp(topic.type) || record.data_bytes < sizeof start || !read_at(record.data, start)) return;
  WireReader wire(start);
  wire.u32();
  messages_.push_back({connection->second, wire.time_ns(), chunk, record.data, record.data_bytes});
}

Status BagFile::unpacked(std::int64_t number, const std::vector<unsigned char>*& bytes) {
  for (const Unpacked& cached : cache_)
    if (cached.chunk == number) {
      bytes = &cached.bytes;
      return {};
    }
  Unpacked& place = cache_[next_in_cache_];
  next_in_cache_ = 1 - next_in_cache_;
  place.chunk = -1;
  const Chunk& chunk = chunks_[static_cast<std::size_t>(number)];
  packed_.resize(chunk.bytes);
  if (!read_file(chunk.position, packed_))
    return {StatusCode::kIo, fmt::format("{} cannot be read any more", path_.string())};
  place.bytes.resize(chunk.unpacked);
  if (Status status = unpack_chunk(chunk.compression, packed_, place.bytes); !status.ok()) return status;
  place.chunk = number;
  bytes = &place.bytes;
  return {};
}

Status BagFile::read(const BagMessage& message, std::vector<unsigned char>& bytes) {
  bytes.resize(message.bytes);
  if (message.chunk < 0) {
    if (read_file(message.position, bytes)) return {};
    return {StatusCode::kIo, fmt::format("{} cannot be read any more", path_.string())};
  }
  const std::vector<unsigned char>* chunk = nullptr;
  if (Status status = unpacked(message.chunk, chunk); !status.ok()) return status;
  std::copy_n(chunk->begin() + static_cast<std::ptrdiff_t>(message.position), message.bytes, bytes.begin());
  return {};
}

void BagFile::remark_on(End end, bool closed) {
  const std::string name = path_.filename().string();
  if (end == End::kBroken && closed)
    remark_ = fmt::format("{} is damaged from byte {} on; what lies before is used", name, stopped_at_);
  else if (end != End::kWhole || !closed)
    remark_ = fmt::format("{} is cut short; what lies before byte {} is used", name,
                          end == End::kWhole ? file_bytes_ : stopped_at_);
  if (broken_chunks_ > 0)
    remark_ += fmt::format("{}{} damaged pieces of {} are left out", remark_.empty() ? "" : "; ",
                           broken_chunks_, name);
}

}  // namespace plvo
