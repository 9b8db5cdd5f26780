// SPDX-License-Identifier: Apache-2.0
// The container MCAP (https://mcap.dev/spec), which rosbag2 and Foxglove record. Its messages are serialised
// as CDR or as in ROS 1; messages of other encodings are passed over.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "plvo/rosbag/containers/chunked_file.hpp"

namespace plvo {

class McapFile final : public ChunkedFile {
 public:
  Status scan(const Take& take) override;

 private:
  struct Record {
    std::uint8_t op = 0;
    std::uint64_t data = 0;  // position
    std::uint64_t bytes = 0;
    bool whole = false;  // its data ends within the available bytes
  };

  // Returns kDamaged for a file that is not MCAP, kUnsupported for one of another version.
  Status check_beginning() override;
  End scan_records(Source& source, std::uint64_t begin, std::uint64_t end, const bool* whole_chunk) override;
  std::uint64_t first_record() const override;
  bool is_closed() const override { return closed_; }

  // Reads the first bytes of a record's data, as many as there are.
  bool read_start(Source& source, const Record& record, std::size_t most);
  End scan_inner(Source& source, const Record& record);
  void add_schema();
  void add_channel();
  void take_record(Source& source, const Record& record);

  bool closed_ = false;                            // the end of the messages was read
  std::map<std::uint16_t, std::string> schemas_;   // the type
  std::map<std::uint16_t, std::size_t> channels_;  // the topic
  std::string other_encoding_;                     // of a channel that is passed over
  std::vector<unsigned char> start_;
};

}  // namespace plvo
