// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/line_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace plvo {

Status LineFile::open(const std::filesystem::path& path) {
  close();
  path_ = path;
  descriptor_ = open_output(path);
  return descriptor_ >= 0 ? Status() : output_failed("create", path_, errno);
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
  if (descriptor < 0) return errno == ENXIO ? Status() : output_failed("create", path, errno);
  ::close(descriptor);
  if (is_new) ::unlink(path.c_str());
  return {};
}

Status LineFile::write(std::string_view line) {
  if (descriptor_ < 0) return {};
  line_.assign(line);
  line_ += '\n';
  const int reason = write_whole(descriptor_, line_);
  return reason == 0 ? Status() : output_failed("write", path_, reason);
}

void LineFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace plvo
