// SPDX-License-Identifier: Apache-2.0
// The container of ROS 1, `#ROSBAG V2.0`: records one after the other, many of them in chunks that may be
// compressed (http://wiki.ros.org/Bags/Format/2.0). The index at the end is not used: it is missing where a
// recording was cut short, and then every message before the cut is still there. Nothing of what a file
// claims is believed before it is compared with the file's size and the bounds below.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "plvo/rosbag/chunk.hpp"

namespace plvo {

struct BagTopic {
  std::string name, type;  // "/camera/rgb/image_color", "sensor_msgs/Image"
  std::size_t messages = 0;
};

struct BagMessage {
  std::size_t topic = 0;       // of topics()
  std::int64_t stamp_ns = 0;   // of the message's header, not of its receipt
  std::int64_t chunk = -1;     // -1: the position is one in the file
  std::uint64_t position = 0;  // in the unpacked chunk
  std::uint32_t bytes = 0;
};

class BagFile {
 public:
  // Reads all of it once. Kept are the places of images, camera_infos and IMU readings; others are counted.
  // kNotFound, kInvalidArgument (not a regular file), kDamaged (not a bag), kUnsupported (another version,
  // encryption).
  Status open(const std::filesystem::path& path);

  const std::vector<BagTopic>& topics() const { return topics_; }
  const std::vector<BagMessage>& messages() const { return messages_; }  // in the file's order
  // What is wrong with the file, of which the rest can be used; empty where nothing is.
  const std::string& remark() const { return remark_; }

  // The bytes of one. kDamaged, kIo.
  Status read(const BagMessage& message, std::vector<unsigned char>& bytes);

 private:
  struct Chunk {
    BagCompression compression = BagCompression::kNone;
    std::uint64_t position = 0;
    std::uint32_t bytes = 0, unpacked = 0;
  };
  struct Record;
  using ReadAt = std::function<bool(std::uint64_t position, std::span<unsigned char> bytes)>;
  enum class End : std::uint8_t { kWhole, kCut, kBroken };

  bool read_file(std::uint64_t position, std::span<unsigned char> bytes);
  Status check_version();
  // The records in [begin, end); chunk: in which they are.
  End scan(const ReadAt& read_at, std::uint64_t begin, std::uint64_t end, std::int64_t chunk);
  End scan_chunk(const Record& record, std::uint64_t end);
  void add_connection(const Record& record, std::span<const unsigned char> data);
  void add_message(const Record& record, const ReadAt& read_at, std::int64_t chunk);
  Status unpacked(std::int64_t chunk, const std::vector<unsigned char>*& bytes);
  void remark_on(End end, bool closed);

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t stopped_at_ = 0;
  std::uint64_t index_position_ = 0;
  std::vector<BagTopic> topics_;
  std::map<std::uint32_t, std::size_t> connections_;  // by the bag's number: whose topic it is
  std::vector<BagMessage> messages_;
  std::vector<Chunk> chunks_;
  std::size_t broken_chunks_ = 0;
  std::string remark_;
  // The last two that were unpacked: one for colour, one for depth.
  struct Unpacked {
    std::int64_t chunk = -1;
    std::vector<unsigned char> bytes;
  };
  std::array<Unpacked, 2> cache_;
  std::size_t next_in_cache_ = 0;
  std::vector<unsigned char> packed_;
};

}  // namespace plvo
