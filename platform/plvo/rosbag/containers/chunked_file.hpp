// SPDX-License-Identifier: Apache-2.0
// A file of records, many of them in chunks that may be compressed: what ROS 1 bags and MCAP files have in
// common. The index at the end is not used: a truncated recording has no index, but still has every message
// before the cut. All sizes in a file are first compared with the file's size and kMaxPiece.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

#include "plvo/rosbag/containers/chunk.hpp"
#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

class ChunkedFile : public MessageFile {
 public:
  Status open_file(const std::filesystem::path& path) override;
  Status scan(const Take& take) override;
  Status read_stored(const BagMessage& place, std::span<unsigned char> bytes) override;
  void release() override;

 protected:
  struct Chunk {
    Compression compression = Compression::kNone;
    std::uint64_t position = 0;
    std::uint64_t bytes = 0, unpacked = 0;
  };
  // The bytes that contain the records: the file, or an unpacked chunk of it.
  struct Source {
    std::function<bool(std::uint64_t position, std::span<unsigned char> bytes)> read;
    const Chunk* unpacked = nullptr;
    std::uint64_t number = BagMessage::kInFile;  // of the chunk, once one of its messages is kept
  };
  enum class End : std::uint8_t { kWhole, kCut, kBroken, kOverrun };  // kOverrun: into the next chunk

  // What a format implements.
  //
  // Checks the first bytes.
  virtual Status check_beginning() = 0;
  // Reads the records from begin to end. `source` is the file or a compressed chunk; whole_chunk: for the
  // records of a chunk, whether it ends within the file; nullptr for the records of the file. A chunk among
  // the records of another ends the reading, so that the content of a file cannot cause a recursion.
  virtual End scan_records(Source& source, std::uint64_t begin, std::uint64_t end,
                           const bool* whole_chunk) = 0;
  // Where the records of the file begin, and whether the recorder closed it.
  virtual std::uint64_t first_record() const = 0;
  virtual bool is_closed() const = 0;

  bool read_file(std::uint64_t position, std::span<unsigned char> bytes);
  // Reads the records of a chunk, in place if it is not compressed. whole: it ends within the file.
  End scan_chunk(Source& file, const Chunk& chunk, bool whole);
  // Hands a message to the visitor of the scan; a failure becomes failure_.
  void take_message(Source& source, std::size_t topic, std::int64_t received_ns, std::uint64_t position,
                    std::uint64_t bytes);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t file_bytes() const { return file_bytes_; }

  // State of a scan.
  Status failure_;
  std::uint64_t stopped_at_ = 0;
  std::size_t broken_chunks_ = 0;

 private:
  struct Unpacked {
    std::uint64_t chunk = BagMessage::kInFile;  // none
    std::vector<unsigned char> bytes;
  };

  Status cannot_be_read_any_more() const;
  Unpacked& next_in_cache();
  Status unpack(const Chunk& chunk, std::vector<unsigned char>& bytes);
  std::string damage(End end) const;

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t file_bytes_ = 0;
  std::vector<Chunk> chunks_;  // compressed chunks with kept messages
  const Take* take_ = nullptr;
  std::size_t large_chunks_ = 0;
  std::array<Unpacked, 2> cache_;  // the last two: one for colour, one for depth
  std::size_t next_in_cache_ = 0;
  std::vector<unsigned char> packed_;
};

}  // namespace plvo
