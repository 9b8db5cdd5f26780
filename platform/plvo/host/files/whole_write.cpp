// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/whole_write.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace plvo {
namespace {

// Only at the end of the file: what others wrote behind it stays.
void take_back(int descriptor, std::size_t bytes) {
  struct stat facts {};
  const off_t end = ::lseek(descriptor, 0, SEEK_CUR);
  if (end < 0 || ::fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode) || facts.st_size != end) return;
  const off_t begin = end - static_cast<off_t>(bytes);
  if (::ftruncate(descriptor, begin) == 0) ::lseek(descriptor, begin, SEEK_SET);
}

const char* advice(int reason) {
  switch (reason) {
    case ENOSPC:
    case EDQUOT: return "free some space or choose another disk";
    case EFBIG: return "raise the limit on the size of files (ulimit -f)";
    case EPIPE: return "the program that reads it has ended";
    default: return "choose a path that can be written";
  }
}

}  // namespace

int open_output(const std::filesystem::path& path) {
  return is_standard_output(path) ? ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0)
                                  : ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
}

int write_whole(int descriptor, std::string_view text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const int reason = written < 0 ? errno : EIO;
      if (done > 0) take_back(descriptor, done);
      return reason;
    }
    done += static_cast<std::size_t>(written);
  }
  return 0;
}

Status output_failed(const char* what, const std::filesystem::path& path, int reason) {
  const std::string name = is_standard_output(path) ? "standard output" : path.string();
  return {StatusCode::kIo,
          fmt::format("cannot {} {}: {}; {}", what, name, std::strerror(reason), advice(reason))};
}

bool is_standard_output(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

}  // namespace plvo
