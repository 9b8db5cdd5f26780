// SPDX-License-Identifier: Apache-2.0
// A folder of rosbag2: one recording in one or several files, all .db3 or all .mcap, plain or packed by zstd
// (FILE.db3.zstd). metadata.yaml is not read, because the files contain everything; so it may be missing. The
// files follow one another by the numbers in their names.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "plvo/rosbag/containers/message_file.hpp"

namespace plvo {

class BagFolder final : public MessageFile {
 public:
  // Returns kNotFound if there are no such files, kInvalidArgument for files of both kinds or too many, and
  // the errors of the files.
  Status open_file(const std::filesystem::path& path) override;
  Status scan(const Take& take) override;
  Status read_stored(const BagMessage& place, std::span<unsigned char> bytes) override;

 private:
  std::vector<std::unique_ptr<MessageFile>> files_;
  std::size_t last_read_ = 0;
  std::string remark_of_files_;  // a file that is missing or left out
};

}  // namespace plvo
