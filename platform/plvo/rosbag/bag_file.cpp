// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/rosbag/messages.hpp"
#include "plvo/rosbag/wire_reader.hpp"

namespace plvo {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
// Largest header of a record; a longer one means damage.
constexpr std::uint32_t kMaxHeader = 1u << 16;
constexpr std::uint32_t kMaxConnection = 1u << 22;  // the text of a message's definition
constexpr std::size_t kMaxTopics = 10'000;
constexpr std::size_t kMaxName = 512;  // of a topic or its type

enum Op : std::uint8_t { kMessageData = 2, kFileHeader = 3, kChunkOp = 5, kConnection = 7 };

// Drops the old content first, so that old and new memory do not exist at once.
void resize_anew(std::vector<unsigned char>& bytes, std::size_t size) {
  if (bytes.capacity() < size) std::vector<unsigned char>().swap(bytes);
  bytes.resize(size);
}

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
  take_message_ = [this](const Record& record, std::size_t topic, Source& source) {
    ++topics_[topic].messages;
    return keep_message(record, topic, source);
  };
  const End end = scan_file();
  if (failure_.ok()) remark_on(end);
  return failure_;
}

Status BagFile::visit(std::string_view type, const Visit& visit) {
  std::size_t left = 0;
  for (const BagTopic& topic : topics_) left += topic.type == type ? topic.messages : 0;
  std::vector<unsigned char> bytes;
  take_message_ = [&](const Record& record, std::size_t topic, Source& source) -> Status {
    if (topics_[topic].type != type || left == 0) return {};
    --left;
    resize_anew(bytes, record.data_bytes <= kMaxPiece ? record.data_bytes : 0);
    if (!source.read(record.data, bytes)) bytes.clear();
    return visit(topic, bytes);
  };
  scan_file();
  if (failure_.ok() && left > 0) return cannot_be_read_any_more();
  return failure_;
}

Status BagFile::cannot_be_read_any_more() const {
  return {StatusCode::kIo, fmt::format("{} cannot be read any more", path_.string())};
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

BagFile::End BagFile::scan_file() {
  failure_ = {};
  broken_chunks_ = large_chunks_ = 0;
  connections_.clear();
  Source file = {
      [this](std::uint64_t position, std::span<unsigned char> bytes) { return read_file(position, bytes); }};
  Record record;
  for (std::uint64_t position = kVersion.size(); position < file_bytes_;) {
    stopped_at_ = position;
    if (const End end = read_record(file, position, file_bytes_, record); end != End::kWhole) return end;
    if (record.op() == kChunkOp) {
      const End end = scan_chunk(file, record);
      if (end == End::kBroken || end == End::kOverrun) ++broken_chunks_;
      if (end == End::kOverrun) {
        position = stopped_at_;
        continue;
      }
    } else if (record.op() == kFileHeader) {
      index_position_ = number_of(record.field("index_pos"), 8);
    } else {
      take_record(record, file);
    }
    if (!failure_.ok()) return End::kBroken;
    if (!record.whole) return End::kCut;
    position = record.data + record.data_bytes;
  }
  return End::kWhole;
}

BagFile::End BagFile::scan_messages(Source& source, std::uint64_t begin, std::uint64_t end,
                                    const Record& outer) {
  Record record;
  for (std::uint64_t position = begin; position < end;) {
    if (source.unpacked == nullptr) stopped_at_ = position;
    if (const End read = read_record(source, position, end, record); read != End::kWhole) return read;
    if (record.op() == kChunkOp) {
      // If either exceeds its end, the length of the outer one is damaged.
      if (source.unpacked == nullptr && !(outer.whole && record.whole)) return End::kOverrun;
      failure_ = {StatusCode::kDamaged,
                  fmt::format("{}: at byte {} a chunk lies within another, which no recorder writes; rosbag "
                              "reindex may mend it",
                              path_.string(), stopped_at_)};
    } else {
      take_record(record, source);
    }
    if (!failure_.ok()) return End::kBroken;
    if (!record.whole) return End::kCut;
    position = record.data + record.data_bytes;
  }
  return End::kWhole;
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
    if (connection != connections_.end()) failure_ = take_message_(record, connection->second, source);
  }
}

BagFile::End BagFile::scan_chunk(Source& file, const Record& record) {
  Chunk chunk;
  if (!compression_of(record.field("compression"), chunk.compression)) return End::kBroken;
  // In an uncompressed chunk, the messages before a cut can be read in place.
  if (chunk.compression == BagCompression::kNone)
    return scan_messages(file, record.data, std::min(file_bytes_, record.data + record.data_bytes), record);
  chunk.position = record.data;
  chunk.bytes = record.data_bytes;
  chunk.unpacked = record.number("size");
  if (!record.whole) return End::kCut;
  if (std::max(chunk.bytes, chunk.unpacked) > kMaxPiece) {
    ++large_chunks_;
    return End::kWhole;
  }
  Unpacked& place = next_in_cache();
  if (!unpack(chunk, place.bytes).ok()) return End::kBroken;
  Source unpacked;
  unpacked.unpacked = &chunk;
  unpacked.read = [&bytes = place.bytes](std::uint64_t position, std::span<unsigned char> out) {
    if (position > bytes.size() || out.size() > bytes.size() - position) return false;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(position), out.size(), out.begin());
    return true;
  };
  const End end = scan_messages(unpacked, 0, place.bytes.size(), record);
  place.chunk = unpacked.number;
  return end == End::kWhole ? End::kWhole : End::kBroken;
}

void BagFile::add_connection(const Record& record, std::span<const unsigned char> data) {
  const std::uint32_t number = record.number("conn");
  const std::string_view name = record.field("topic"), type = field_of(data, "type");
  if (connections_.contains(number) || name.empty() || connections_.size() >= kMaxTopics) return;
  if (std::max(name.size(), type.size()) > kMaxName) return;
  const auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
    return other.name == name && other.type == type;
  });
  connections_.emplace(number, static_cast<std::size_t>(topic - topics_.begin()));
  if (topic != topics_.end()) return;
  topics_.push_back({std::string(name), std::string(type), 0});
  messages_.emplace_back();
}

Status BagFile::keep_message(const Record& record, std::size_t topic, Source& source) {
  const bool image = topics_[topic].type == kImageType;
  const bool first_info = topics_[topic].type == kCameraInfoType && messages_[topic].empty();
  unsigned char start[12];  // of the message's header: a counter, then the stamp
  if (!(image || first_info) || record.data_bytes < sizeof start || !source.read(record.data, start))
    return {};
  if (image && ++images_ > kMostImages)
    return {StatusCode::kInvalidArgument,
            fmt::format("{} holds more than {} images, of which plvo reads no more; make a shorter one of it "
                        "with rosbag filter",
                        path_.string(), kMostImages)};
  if (source.unpacked != nullptr && source.number == BagMessage::kInFile) {
    source.number = static_cast<std::uint32_t>(chunks_.size());
    chunks_.push_back(*source.unpacked);
  }
  WireReader wire(start);
  wire.u32();
  messages_[topic].push_back({wire.time_ns(), record.data, record.data_bytes, source.number});
  return {};
}

BagFile::Unpacked& BagFile::next_in_cache() {
  Unpacked& place = cache_[next_in_cache_];
  next_in_cache_ = 1 - next_in_cache_;
  place.chunk = BagMessage::kInFile;
  return place;
}

Status BagFile::unpack(const Chunk& chunk, std::vector<unsigned char>& bytes) {
  resize_anew(packed_, chunk.bytes);
  if (!read_file(chunk.position, packed_)) return cannot_be_read_any_more();
  resize_anew(bytes, chunk.unpacked);
  return unpack_chunk(chunk.compression, packed_, bytes);
}

Status BagFile::read(const BagMessage& message, std::vector<unsigned char>& bytes) {
  if (message.bytes > kMaxPiece)
    return {StatusCode::kDamaged, fmt::format("the message has {} bytes, and at most {} are read of one",
                                              message.bytes, kMaxPiece)};
  resize_anew(bytes, message.bytes);
  if (message.chunk == BagMessage::kInFile)
    return read_file(message.position, bytes) ? Status() : cannot_be_read_any_more();
  auto place = std::find_if(cache_.begin(), cache_.end(),
                            [&](const Unpacked& cached) { return cached.chunk == message.chunk; });
  if (place == cache_.end()) {
    place = cache_.begin() + static_cast<std::ptrdiff_t>(next_in_cache_);
    if (Status status = unpack(chunks_[message.chunk], next_in_cache().bytes); !status.ok()) return status;
    place->chunk = message.chunk;
  }
  std::copy_n(place->bytes.begin() + static_cast<std::ptrdiff_t>(message.position), message.bytes,
              bytes.begin());
  return {};
}

void BagFile::remark_on(End end) {
  const bool closed = index_position_ != 0 && index_position_ <= file_bytes_;
  const std::string name = path_.filename().string();
  const auto add = [this](const std::string& sentence) {
    remark_ += (remark_.empty() ? "" : "; ") + sentence;
  };
  if (end == End::kBroken && closed)
    add(fmt::format("{} is damaged from byte {} on; what lies before is used", name, stopped_at_));
  else if (end != End::kWhole || !closed)
    add(fmt::format("{} is cut short; what lies before byte {} is used", name,
                    end == End::kWhole ? file_bytes_ : stopped_at_));
  if (broken_chunks_ > 0) add(fmt::format("{} damaged pieces of {} are left out", broken_chunks_, name));
  if (large_chunks_ > 0)
    add(
        fmt::format("{} compressed pieces of {} are larger than the {} MiB that are read, and left out: "
                    "rosbag decompress makes a bag that can be read",
                    large_chunks_, name, kMaxPiece >> 20));
}

}  // namespace plvo
