// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/map_files.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>

#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/owned_descriptor.hpp"
#include "plvo/host/files/whole_write.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as many as Linux follows

// Where the bytes go, and which name they get then.
struct MapTarget {
  explicit MapTarget(const fs::path& path) : name(path) {
    std::error_code ignored;
    // A link keeps pointing to its file, which may not be there yet.
    for (int i = 0; i < kMostLinks && fs::is_symlink(name, ignored); ++i)
      name = name.parent_path() / fs::read_symlink(name, ignored);
    is_file = !is_standard_output(path) && (!fs::exists(name, ignored) || fs::is_regular_file(name, ignored));
    part = name;
    part += ".part";
  }
  fs::path name, part;
  bool is_file = false;
};

class DescriptorSink final : public ByteSink {
 public:
  DescriptorSink(int descriptor, const fs::path& path) : descriptor_(descriptor), path_(path) {}
  Status write(std::span<const std::byte> piece) override {
    const int reason =
        write_whole(descriptor_, std::string_view(reinterpret_cast<const char*>(piece.data()), piece.size()));
    return reason == 0 ? Status() : output_failed("write", path_, reason);
  }

 private:
  int descriptor_;
  const fs::path& path_;
};

Status write_to(const MapTarget& target, Map& map) {
  const fs::path& path = target.is_file ? target.part : target.name;
  const OwnedDescriptor file(open_output(path));
  if (file.get() < 0) return output_failed("create", path, errno);
  DescriptorSink sink(file.get(), path);
  if (Status status = map.save(sink); !status.ok()) return status;
  // On the disk, not only with the operating system: the new name must not come first.
  if (target.is_file && ::fsync(file.get()) != 0) return output_failed("write", path, errno);
  return {};
}

Status of_file(const fs::path& path, const Status& status) {
  return Status(status.code(), path.string()).append(": ").append(status.message());
}

Status read_bytes(const fs::path& path, std::vector<unsigned char>& bytes) {
  return read_input_file(path, most_map_file_bytes(), bytes);
}

Status load_bytes(const fs::path& path, const std::vector<unsigned char>& bytes, Map& map) {
  SpanSource source(std::as_bytes(std::span(bytes)));
  if (Status status = map.load(source); !status.ok()) return of_file(path, status);
  if (source.left() == 0) return {};
  return {StatusCode::kDamaged,
          fmt::format("{}: {} bytes follow the end of the map; make the map again, or use a copy",
                      path.string(), source.left())};
}

}  // namespace

Status check_map_output(const fs::path& path) {
  const MapTarget target(path);
  if (Status status = LineFile::check(target.name); !status.ok()) return status;
  return target.is_file ? LineFile::check(target.part) : Status();
}

Status save_map(const fs::path& path, Map& map) {
  const MapTarget target(path);
  Status status = write_to(target, map);
  if (!target.is_file) return status;
  if (status.ok() && ::rename(target.part.c_str(), target.name.c_str()) != 0)
    status = output_failed("create", path, errno);
  if (!status.ok()) ::unlink(target.part.c_str());
  return status;
}

Status load_map(const fs::path& path, Map& map) {
  std::vector<unsigned char> bytes;
  if (Status status = read_bytes(path, bytes); !status.ok()) return status;
  return load_bytes(path, bytes, map);
}

Status StoredMap::open(const fs::path& path) {
  std::vector<unsigned char> bytes;
  if (Status status = read_bytes(path, bytes); !status.ok()) return status;
  SpanSource source(std::as_bytes(std::span(bytes)));
  if (Status status = read_map_info(source, info_); !status.ok()) return of_file(path, status);
  memory_.assign(Map::required_bytes(info_.limits(), info_.width, info_.height), std::byte{0});
  if (Status status = map_.init(memory_, info_.camera(), Config(), info_.limits()); !status.ok())
    return of_file(path, status);
  return load_bytes(path, bytes, map_);
}

}  // namespace plvo
