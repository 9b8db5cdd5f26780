// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/message_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "plvo/host/files/reader_limits.hpp"
#include "plvo/rosbag/containers/chunk.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

constexpr std::size_t kMostTopics = 10'000;
constexpr std::size_t kMostKept = 100;  // messages of a topic without images

// "sensor_msgs/msg/Image" of ROS 2 becomes "sensor_msgs/Image", as in ROS 1.
std::string ros1_type(std::string_view type) {
  std::string name(type);
  if (const std::size_t middle = name.find("/msg/"); middle != std::string::npos) name.erase(middle, 4);
  return name;
}

// A message in CDR begins with a zero byte, so it cannot be taken for a compressed one.
bool is_packed(WireFormat wire, std::span<const unsigned char> bytes) {
  return wire == WireFormat::kCdr && is_zstd(bytes);
}

}  // namespace

Status MessageFile::open(const std::filesystem::path& path) {
  const Status status = open_file(path);
  return status.ok() ? index(path) : status;
}

Status MessageFile::index(const std::filesystem::path& path) {
  path_ = path;
  return scan([this](Found& found) {
    BagTopic& topic = topics_[found.topic];
    if (topic.messages == 0) topic.first_received_ns = found.received_ns;
    if (topic.messages > 0)
      topic.longest_gap_ns = std::max(topic.longest_gap_ns, found.received_ns - topic.last_received_ns);
    topic.last_received_ns = found.received_ns;
    ++topic.messages;
    return keep_message(found);
  });
}

std::optional<std::size_t> MessageFile::find_topic(std::string_view name, std::string_view type) const {
  for (std::size_t i = 0; i < topics_.size(); ++i)
    if (topics_[i].name == name && topics_[i].type == type) return i;
  return {};
}

std::size_t MessageFile::topic_number(std::string_view name, std::string_view type, WireFormat wire) {
  if (name.empty() || std::max(name.size(), type.size()) > kMostTopicName) return kNoTopic;
  const std::string known_type = ros1_type(type);
  const auto topic = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
    return other.name == name && other.type == known_type && other.wire == wire;
  });
  if (topic != topics_.end()) return static_cast<std::size_t>(topic - topics_.begin());
  if (topics_.size() >= kMostTopics) return kNoTopic;
  BagTopic added;
  added.name = name;
  added.type = known_type;
  added.wire = wire;
  topics_.push_back(std::move(added));
  messages_.emplace_back();
  return topics_.size() - 1;
}

Status MessageFile::keep_message(Found& found) {
  const BagTopic& topic = topics_[found.topic];
  const bool image = is_image_type(topic.type);
  if (!image && messages_[found.topic].size() >= kMostKept) return {};
  found.place.stamp_ns = found.received_ns;
  found.place.wire = topic.wire;
  if (image) {
    std::array<unsigned char, kBytesOfStamp> start{};
    if (found.place.bytes < start.size() || !read_start(found, start).ok()) return {};
    found.place.stamp_ns = stamp_of_message(topic.wire, start);
    if (++images_ > kMostImages)
      return {StatusCode::kInvalidArgument,
              fmt::format("{} holds more than {} images, of which plvo reads no more; split it",
                          path_.string(), kMostImages)};
  }
  if (found.keep) found.keep();
  messages_[found.topic].push_back(found.place);
  return {};
}

Status MessageFile::read_start(const Found& found, std::span<unsigned char> start) {
  const Status damaged(StatusCode::kDamaged, "the message cannot be read");
  if (!found.read(start)) return damaged;
  if (!is_packed(topics_[found.topic].wire, start)) return {};
  if (found.place.bytes > kMaxPiece) return damaged;
  resize_anew(stored_, found.place.bytes);
  return found.read(stored_) ? unpack_zstd_start(stored_, start) : damaged;
}

Status MessageFile::read(const BagMessage& message, std::vector<unsigned char>& bytes) {
  if (message.bytes > kMaxPiece)
    return {StatusCode::kDamaged, fmt::format("the message has {} bytes, and at most {} are read of one",
                                              message.bytes, kMaxPiece)};
  resize_anew(bytes, message.bytes);
  if (Status status = read_stored(message, bytes); !status.ok() || !is_packed(message.wire, bytes))
    return status;
  stored_.swap(bytes);
  return unpack_zstd_message(stored_, kMaxPiece, bytes);
}

bool MessageFile::read_first(std::size_t topic, std::vector<unsigned char>& bytes) {
  return !messages_[topic].empty() && read(messages_[topic].front(), bytes).ok();
}

Status MessageFile::visit(std::string_view type, const Visit& visit) {
  std::size_t left = 0;
  for (const BagTopic& topic : topics_) left += topic.type == type ? topic.messages : 0;
  std::vector<unsigned char> bytes, stored;
  const Status status = scan([&](Found& found) -> Status {
    if (topics_[found.topic].type != type || left == 0) return {};
    --left;
    resize_anew(stored, found.place.bytes <= kMaxPiece ? found.place.bytes : 0);
    if (!found.read(stored)) stored.clear();
    if (!is_packed(topics_[found.topic].wire, stored)) return visit(found.topic, stored);
    if (!unpack_zstd_message(stored, kMaxPiece, bytes).ok()) bytes.clear();
    return visit(found.topic, bytes);
  });
  if (status.ok() && left > 0)
    return {StatusCode::kIo, fmt::format("{} cannot be read any more", path_.string())};
  return status;
}

Status MessageFile::require_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    return {StatusCode::kNotFound, fmt::format("{} is not there", path.string())};
  if (!std::filesystem::is_regular_file(status))
    return {StatusCode::kInvalidArgument, fmt::format("{} is not a regular file", path.string())};
  return {};
}

void MessageFile::resize_anew(std::vector<unsigned char>& bytes, std::size_t size) {
  if (bytes.capacity() < size) std::vector<unsigned char>().swap(bytes);
  bytes.resize(size);
}

}  // namespace plvo
