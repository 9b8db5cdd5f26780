// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/line_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace plvo {

Status LineFile::failed(const char* what) const {
  const char* advice =
      errno == ENOSPC ? "free some space or choose another disk" : "choose a path that can be written";
  return {StatusCode::kIo,
          fmt::format("cannot {} {}: {}; {}", what, path_.string(), std::strerror(errno), advice)};
}

Status LineFile::open(const std::filesystem::path& path) {
  close();
  path_ = path;
  length_ = 0;
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  return descriptor_ >= 0 ? Status() : failed("create");
}

Status LineFile::open(const std::filesystem::path& path, std::string_view first_line) {
  const Status status = open(path);
  return status.ok() ? write(first_line) : status;
}

Status LineFile::write(std::string_view line) {
  if (descriptor_ < 0) return {};
  line_.assign(line);
  line_ += '\n';
  std::size_t done = 0;
  while (done < line_.size()) {
    const ssize_t written = ::write(descriptor_, line_.data() + done, line_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const Status status = failed("write");
      // Take the cut line back. A pipe or device cannot do that, but has nothing to keep valid either.
      if (::ftruncate(descriptor_, length_) == 0) ::lseek(descriptor_, length_, SEEK_SET);
      return status;
    }
    done += static_cast<std::size_t>(written);
  }
  length_ += static_cast<std::int64_t>(line_.size());
  return {};
}

void LineFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace plvo
