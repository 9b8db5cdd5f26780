// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/line_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace plvo {
namespace {

Status failed(const char* what, const std::filesystem::path& path) {
  const char* advice =
      errno == ENOSPC ? "free some space or choose another disk" : "choose a path that can be written";
  const std::string name = is_standard_output(path) ? "standard output" : path.string();
  return {StatusCode::kIo, fmt::format("cannot {} {}: {}; {}", what, name, std::strerror(errno), advice)};
}

}  // namespace

bool is_standard_output(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

Status LineFile::open(const std::filesystem::path& path) {
  close();
  path_ = path;
  length_ = 0;
  ours_ = !is_standard_output(path);
  descriptor_ = ours_ ? ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)
                      : ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  return descriptor_ >= 0 ? Status() : failed("create", path_);
}

Status LineFile::open(const std::filesystem::path& path, std::string_view first_line) {
  const Status status = open(path);
  return status.ok() ? write(first_line) : status;
}

Status LineFile::check(const std::filesystem::path& path) {
  if (is_standard_output(path)) return {};
  const bool is_new = ::access(path.c_str(), F_OK) != 0;
  // O_NONBLOCK: a pipe that nobody reads yet is no error, and must not be waited for.
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
  if (descriptor < 0) return errno == ENXIO ? Status() : failed("create", path);
  ::close(descriptor);
  if (is_new) ::unlink(path.c_str());
  return {};
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
      const Status status = failed("write", path_);
      if (ours_) take_back_to(length_);
      return status;
    }
    done += static_cast<std::size_t>(written);
  }
  length_ += static_cast<std::int64_t>(line_.size());
  return {};
}

// A pipe or device cannot do that, but has nothing to keep valid either.
void LineFile::take_back_to(std::int64_t length) const {
  if (::ftruncate(descriptor_, length) == 0) ::lseek(descriptor_, length, SEEK_SET);
}

void LineFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace plvo
