// SPDX-License-Identifier: Apache-2.0
// The container of ROS 1, `#ROSBAG V2.0`: a sequence of records, many of them in chunks that may be
// compressed (http://wiki.ros.org/Bags/Format/2.0). The index at the end is not used: a truncated recording
// has no index, but still has every message before the cut. All sizes in a file are first compared with the
// file's size and the bounds below.
//
// The reader is ours because librosbag is not designed for hostile files: it allocates what the header of a
// chunk claims, up to 4 GiB, before it reads, and only asserts that the sizes agree (ros_comm,
// tools/rosbag_storage/src/bag.cpp). It also needs the index at the end, and throws BagUnindexedException at
// a recording without one.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/rosbag/chunk.hpp"

namespace plvo {

// Largest message and largest compressed chunk, packed and unpacked: an image of kMaxImageSide² with four
// bytes a pixel, and its surroundings.
inline constexpr std::uint32_t kMaxPiece = 72u << 20;

struct BagTopic {
  std::string name, type;  // "/camera/rgb/image_color", "sensor_msgs/Image"
  std::size_t messages = 0;
};

struct BagMessage {
  static constexpr std::uint32_t kInFile = UINT32_MAX;

  std::int64_t stamp_ns = 0;   // from the message's header, not the time of receipt
  std::uint64_t position = 0;  // in the file, or in the unpacked chunk
  std::uint32_t bytes = 0;
  std::uint32_t chunk = kInFile;  // index of the compressed chunk
};

class BagFile {
 public:
  // Reads the whole file once. Keeps the positions of images, at most kMostImages, and of the first
  // camera_info of each topic. Returns kNotFound, kInvalidArgument (not a regular file; more images),
  // kDamaged (not a bag; a chunk within a chunk), kUnsupported (another version, encryption).
  Status open(const std::filesystem::path& path);

  const std::vector<BagTopic>& topics() const { return topics_; }
  // The kept messages of one of topics(), in the file's order.
  const std::vector<BagMessage>& messages(std::size_t topic) const { return messages_[topic]; }
  // Describes damage of a file whose rest can be used; empty if there is none.
  const std::string& remark() const { return remark_; }

  // Reads the bytes of a message. Returns kDamaged, also for one that is larger than kMaxPiece; kIo.
  Status read(const BagMessage& message, std::vector<unsigned char>& bytes);

  // Reads the whole file once more. Each message of the type goes to `visit`, in the file's order; one that
  // is larger than kMaxPiece goes without its bytes. An error that `visit` returns ends the reading. Returns
  // that error, or kIo.
  using Visit = std::function<Status(std::size_t topic, std::span<const unsigned char> bytes)>;
  Status visit(std::string_view type, const Visit& visit);

 private:
  struct Chunk {
    BagCompression compression = BagCompression::kNone;
    std::uint64_t position = 0;
    std::uint32_t bytes = 0, unpacked = 0;
  };
  struct Unpacked {
    std::uint32_t chunk = BagMessage::kInFile;  // none
    std::vector<unsigned char> bytes;
  };
  struct Record;
  // The bytes that contain the records: the file, or an unpacked chunk of it.
  struct Source {
    std::function<bool(std::uint64_t position, std::span<unsigned char> bytes)> read;
    const Chunk* unpacked = nullptr;
    std::uint32_t number = BagMessage::kInFile;  // of the chunk, once one of its messages is kept
  };
  enum class End : std::uint8_t { kWhole, kCut, kBroken, kOverrun };  // kOverrun: into the next chunk

  bool read_file(std::uint64_t position, std::span<unsigned char> bytes);
  Status cannot_be_read_any_more() const;
  Status check_version();
  // Reads the file from begin to end. Messages go to take_message_; its failure ends the reading.
  End scan_file();
  End scan_chunk(Source& file, const Record& record);
  // Reads connections and messages. A chunk among them ends the reading, so that the content of a file cannot
  // cause a recursion.
  End scan_messages(Source& source, std::uint64_t begin, std::uint64_t end, const Record& outer);
  End read_record(Source& source, std::uint64_t position, std::uint64_t end, Record& record);
  void take_record(const Record& record, Source& source);
  void add_connection(const Record& record, std::span<const unsigned char> data);
  Status keep_message(const Record& record, std::size_t topic, Source& source);
  Unpacked& next_in_cache();
  Status unpack(const Chunk& chunk, std::vector<unsigned char>& bytes);
  void remark_on(End end);

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t index_position_ = 0;
  std::vector<BagTopic> topics_;
  std::map<std::uint32_t, std::size_t> connections_;  // topic by the bag's connection number
  std::vector<std::vector<BagMessage>> messages_;     // of each topic
  std::size_t images_ = 0;                            // number of kept images
  std::vector<Chunk> chunks_;                         // compressed chunks with kept messages
  std::string remark_;
  // State while the file is read from begin to end.
  std::function<Status(const Record& record, std::size_t topic, Source& source)> take_message_;
  Status failure_;
  std::uint64_t stopped_at_ = 0;
  std::size_t broken_chunks_ = 0, large_chunks_ = 0;
  std::array<Unpacked, 2> cache_;  // the last two: one for colour, one for depth
  std::size_t next_in_cache_ = 0;
  std::vector<unsigned char> packed_;
};

}  // namespace plvo
