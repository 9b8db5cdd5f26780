// SPDX-License-Identifier: Apache-2.0
// The container of ROS 1, `#ROSBAG V2.0` (http://wiki.ros.org/Bags/Format/2.0).
//
// The reader is ours because librosbag is not designed for hostile files: it allocates what the header of a
// chunk claims, up to 4 GiB, before it reads, and only asserts that the sizes agree (ros_comm,
// tools/rosbag_storage/src/bag.cpp). It also needs the index at the end, and throws BagUnindexedException at
// a recording without one.
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "plvo/rosbag/containers/chunked_file.hpp"

namespace plvo {

class BagFile final : public ChunkedFile {
 private:
  struct Record;

  // Returns kDamaged for a file that is not a bag, kUnsupported for one of another version.
  Status check_beginning() override;
  End scan_records(Source& source, std::uint64_t begin, std::uint64_t end, const bool* whole_chunk) override;
  std::uint64_t first_record() const override;
  bool is_closed() const override { return index_position_ != 0 && index_position_ <= file_bytes(); }

  End scan_inner(Source& source, const Record& record);
  End read_record(Source& source, std::uint64_t position, std::uint64_t end, Record& record);
  void take_record(const Record& record, Source& source);
  void add_connection(const Record& record, std::span<const unsigned char> data);

  std::uint64_t index_position_ = 0;
  std::map<std::uint32_t, std::size_t> connections_;  // topic by the bag's connection number
};

}  // namespace plvo
