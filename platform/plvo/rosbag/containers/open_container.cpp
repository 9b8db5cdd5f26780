// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/open_container.hpp"

#include <fmt/core.h>
#include <stdlib.h>

#include <string>
#include <utility>

#include "plvo/rosbag/containers/bag_file.hpp"
#include "plvo/rosbag/containers/bag_folder.hpp"
#include "plvo/rosbag/containers/chunk.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"
#include "plvo/rosbag/containers/mcap_file.hpp"
#include "plvo/rosbag/containers/sqlite_file.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

bool is_packed_file(const fs::path& path) {
  const std::string first = first_bytes_of(path);
  return is_zstd({reinterpret_cast<const unsigned char*>(first.data()), first.size()});
}

std::unique_ptr<MessageFile> make_container(Container container) {
  switch (container) {
    case Container::kBag: return std::make_unique<BagFile>();
    case Container::kMcap: return std::make_unique<McapFile>();
    case Container::kSqlite: return std::make_unique<SqliteFile>();
    case Container::kFolder: return std::make_unique<BagFolder>();
    case Container::kNone: break;
  }
  return nullptr;
}

// A folder that only this user can read; it and what is in it are removed at the end.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "plvo-XXXXXX").string();
    if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Status open_packed(const fs::path& path, MessageFile& file) {
  const PrivateFolder folder;
  if (folder.path().empty())
    return {
        StatusCode::kIo,
        fmt::format("there is no folder to unpack {} to: set TMPDIR to one, or unpack it yourself (unzstd)",
                    path.string())};
  std::error_code error;
  const std::uintmax_t most = fs::space(folder.path(), error).available / 10 * 9;  // leaves room for others
  const fs::path unpacked = folder.path() / path.stem();
  Status status = unpack_zstd_file(path, error ? 0 : most, unpacked);
  // An open file stays readable after it is removed.
  return status.ok() ? file.open_file(unpacked) : status;
}

}  // namespace

Status open_container(const fs::path& path, std::unique_ptr<MessageFile>& file) {
  std::unique_ptr<MessageFile> made = make_container(container_of(path));
  if (made == nullptr)
    return {StatusCode::kUnsupported, fmt::format("{} is not a recording of messages", path.string())};
  if (Status status = is_packed_file(path) ? open_packed(path, *made) : made->open_file(path); !status.ok())
    return status;
  file = std::move(made);
  return {};
}

Status open_messages(const fs::path& path, std::unique_ptr<MessageFile>& file) {
  std::unique_ptr<MessageFile> opened;
  Status status = open_container(path, opened);
  if (status.ok()) status = opened->index(path);
  if (status.ok()) file = std::move(opened);
  return status;
}

}  // namespace plvo
