// SPDX-License-Identifier: Apache-2.0
// The reading layer that all containers of messages share: ROS 1 bags, MCAP files, SQLite files of rosbag2
// and folders of the two. A container only finds messages (scan) and gives their bytes (read_stored). This
// class keeps the topics, the positions of the messages that are needed, and unpacks messages that rosbag2
// compressed one by one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/rosbag/messages/wire_reader.hpp"

namespace plvo {

// Largest message, and largest compressed chunk, packed and unpacked: an image of kMaxImageSide² with four
// bytes a pixel, and its surroundings.
inline constexpr std::uint32_t kMaxPiece = 72u << 20;

struct BagTopic {
  std::string name;                     // "/camera/rgb/image_color"
  std::string type;                     // "sensor_msgs/Image", also for ROS 2's sensor_msgs/msg/Image
  WireFormat wire = WireFormat::kRos1;  // how its messages are serialised
  std::size_t messages = 0;
  // When the recorder received its messages, on the recorder's clock.
  std::int64_t first_received_ns = 0, last_received_ns = 0, longest_gap_ns = 0;
};

struct BagMessage {
  static constexpr std::uint64_t kInFile = UINT64_MAX;

  std::int64_t stamp_ns = 0;      // from the header of an image; else the time of receipt
  std::uint64_t position = 0;     // in the file or the unpacked chunk; in SQLite the number of the row
  std::uint64_t chunk = kInFile;  // number of the compressed chunk
  std::uint32_t bytes = 0;        // as stored
  std::uint32_t file = 0;         // of a folder
  WireFormat wire = WireFormat::kRos1;
};

class MessageFile {
 public:
  virtual ~MessageFile() = default;

  // Opens a file and reads it once. An object opens one recording.
  Status open(const std::filesystem::path& path);
  // Reads the opened recording once. path: for messages. Keeps the positions of all images, at most
  // kMostImages, and of the first messages of every other topic. Returns kNotFound, kInvalidArgument (not a
  // regular file; more images), kDamaged, kUnsupported.
  Status index(const std::filesystem::path& path);

  const std::vector<BagTopic>& topics() const { return topics_; }
  // The kept messages of one of topics(), in the order of the recording.
  const std::vector<BagMessage>& messages(std::size_t topic) const { return messages_[topic]; }
  // Describes damage of a recording whose rest can be used; empty if there is none.
  const std::string& remark() const { return remark_; }

  // Reads the bytes of a message of a topic. Returns kDamaged, also for one that is larger than kMaxPiece;
  // kIo.
  Status read(const BagMessage& message, std::vector<unsigned char>& bytes);

  // Reads the whole recording once more. Each message of the type goes to `visit`, in the order of the
  // recording; one that cannot be read goes without its bytes. An error that `visit` returns ends the
  // reading. Returns that error, or kIo.
  using Visit = std::function<Status(std::size_t topic, std::span<const unsigned char> bytes)>;
  Status visit(std::string_view type, const Visit& visit);

  // What a container implements, and what a folder calls of its files.
  //
  // Opens the file and checks that it is of this kind. Returns kNotFound, kInvalidArgument (not a regular
  // file), kPermission, kDamaged, kUnsupported.
  virtual Status open_file(const std::filesystem::path& path) = 0;
  // A message that a scan comes to. read: its stored bytes from the beginning, as many as `bytes` takes.
  struct Found {
    std::size_t topic = 0;
    std::int64_t received_ns = 0;
    BagMessage place;
    std::function<bool(std::span<unsigned char> bytes)> read;
    std::function<void()> keep;  // called if the place is kept, before it is copied; may be empty
  };
  // Reads the recording from begin to end. Each message goes to `take`; its failure ends the reading.
  using Take = std::function<Status(Found& found)>;
  virtual Status scan(const Take& take) = 0;
  // bytes: has the size place.bytes.
  virtual Status read_stored(const BagMessage& place, std::span<unsigned char> bytes) = 0;
  // Frees the memory that reading took; reading goes on afterwards.
  virtual void release() {}

 protected:
  // Finds the topic, or adds it. Returns kNoTopic for a name or type that is empty or too long, and for one
  // topic too many.
  static constexpr std::size_t kNoTopic = SIZE_MAX;
  static constexpr std::size_t kMostTopicName = 512;  // letters, also of its type
  std::size_t topic_number(std::string_view name, std::string_view type, WireFormat wire);
  void set_remark(std::string remark) { remark_ = std::move(remark); }
  // Drops the old content first, so that old and new memory do not exist at once.
  static void resize_anew(std::vector<unsigned char>& bytes, std::size_t size);

 private:
  Status keep_message(Found& found);
  Status read_start(const Found& found, std::span<unsigned char> start);

  std::filesystem::path path_;
  std::vector<BagTopic> topics_;
  std::vector<std::vector<BagMessage>> messages_;  // of each topic
  std::size_t images_ = 0;                         // number of kept images
  std::string remark_;
  std::vector<unsigned char> stored_;
};

}  // namespace plvo
