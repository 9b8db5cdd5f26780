// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stream/line_reader.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace plvo {
namespace {

Status cannot_read(const std::string& path, int reason) {
  const StatusCode code = reason == ENOENT || reason == ENOTDIR ? StatusCode::kNotFound
                          : reason == EACCES || reason == EPERM ? StatusCode::kPermission
                                                                : StatusCode::kIo;
  return {code, fmt::format("cannot read {}: {}", path, std::strerror(reason))};
}

}  // namespace

LineReader::~LineReader() {
  if (owned_) ::close(descriptor_);
}

Status LineReader::open(const std::string& path) {
  if (path == "-") {
    descriptor_ = STDIN_FILENO;
    return {};
  }
  // O_NONBLOCK: a named pipe without a writer must not hold us.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return cannot_read(path, errno);
  descriptor_ = descriptor;
  owned_ = true;
  struct stat facts {};
  if (::fstat(descriptor, &facts) == 0 && S_ISDIR(facts.st_mode))
    return {StatusCode::kInvalidArgument, fmt::format("cannot read {}: it is a folder", path)};
  return {};
}

bool LineReader::next(std::string& line) {
  for (;;) {
    const std::size_t end = buffer_.find('\n');
    if (end == std::string::npos && buffer_.size() <= kLongestLine) {
      if (!read_some()) return false;
      continue;
    }
    const bool rest_of_a_line = cut_;
    cut_ = end == std::string::npos;
    line = buffer_.substr(0, std::min(end, kLongestLine));
    buffer_.erase(0, cut_ ? std::string::npos : end + 1);
    if (!rest_of_a_line) return true;
  }
}

// False if nothing is there now. poll() tells that read() does not wait: standard input, which others may
// share, stays as it is.
bool LineReader::read_some() {
  pollfd ready{descriptor_, POLLIN, 0};
  if (::poll(&ready, 1, 0) <= 0) return false;
  if ((ready.revents & POLLIN) == 0) {
    ended_ = true;
    return false;
  }
  std::array<char, 4096> bytes;
  const ssize_t got = ::read(descriptor_, bytes.data(), bytes.size());
  if (got > 0) buffer_.append(bytes.data(), static_cast<std::size_t>(got));
  ended_ = got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN);
  return got > 0;
}

}  // namespace plvo
