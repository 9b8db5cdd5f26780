// SPDX-License-Identifier: Apache-2.0
// The container SQLite of rosbag2 (FILE.db3): a table of topics and one of messages. The file is opened
// read-only and as one that does not change. A database can contain code (views, triggers, virtual tables):
// these are off, its sizes are limited, and only plain tables are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>

#include "plvo/rosbag/containers/message_file.hpp"

struct sqlite3;
struct sqlite3_blob;

namespace plvo {

class SqliteFile final : public MessageFile {
 public:
  // Returns kDamaged for a file that is not such a database.
  Status open_file(const std::filesystem::path& path) override;
  Status scan(const Take& take) override;
  Status read_stored(const BagMessage& place, std::span<unsigned char> bytes) override;
  void release() override;

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct CloseBlob {
    void operator()(sqlite3_blob* blob) const;
  };

  Status restrict_database();
  bool has_tables();
  Status read_topics();
  // Opens the data of a message. Returns its size, or -1.
  int open_data(std::int64_t row);
  Status damaged(const char* what) const;

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  std::unique_ptr<sqlite3_blob, CloseBlob> data_;
  std::map<std::int64_t, std::size_t> topics_by_number_;
  int steps_left_ = 0;  // of SQLite's machine, for one row
};

}  // namespace plvo
