// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/input_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "plvo/host/files/owned_descriptor.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

Status failed(const fs::path& path, int reason) {
  const StatusCode code = reason == ENOENT || reason == ENOTDIR ? StatusCode::kNotFound
                          : reason == EACCES || reason == EPERM ? StatusCode::kPermission
                                                                : StatusCode::kIo;
  return {code, fmt::format("cannot read {}: {}", path.string(), std::strerror(reason))};
}

Status judge(const fs::path& path, const struct stat& facts, std::uintmax_t limit_bytes) {
  if (S_ISDIR(facts.st_mode))
    return {StatusCode::kInvalidArgument,
            fmt::format("cannot read {}: it is a folder; name a file", path.string())};
  if (!S_ISREG(facts.st_mode)) {
    const char* what = S_ISFIFO(facts.st_mode) ? "a pipe" : S_ISSOCK(facts.st_mode) ? "a socket" : "a device";
    return {StatusCode::kInvalidArgument,
            fmt::format("cannot read {}: it is {}; save what comes from it in a file, and name that",
                        path.string(), what)};
  }
  if (static_cast<std::uintmax_t>(facts.st_size) > limit_bytes)
    return {StatusCode::kInvalidArgument,
            fmt::format("cannot read {}: it has {} bytes, more than the {} that are read of such a file",
                        path.string(), facts.st_size, limit_bytes)};
  return {};
}

// Up to the end of the file, in as many steps as it takes. A file may also be longer than it says (those of
// the kernel say 0), or grow meanwhile.
Status read_to_end(const fs::path& path, int descriptor, std::uintmax_t limit_bytes,
                   std::vector<unsigned char>& bytes) {
  constexpr std::size_t kStep = 64u << 10;
  std::size_t done = 0;
  for (;;) {
    unsigned char next = 0;  // whether there is more than fits
    const bool full = done == bytes.size();
    const ssize_t got =
        full ? ::read(descriptor, &next, 1) : ::read(descriptor, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return failed(path, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
    if (!full) continue;
    if (done > limit_bytes)
      return {StatusCode::kInvalidArgument,
              fmt::format("cannot read {}: it is longer than the {} bytes that are read of such a file",
                          path.string(), limit_bytes)};
    bytes.resize(static_cast<std::size_t>(std::min<std::uintmax_t>(limit_bytes, done + kStep)));
    bytes[done - 1] = next;
  }
  bytes.resize(done);
  return {};
}

}  // namespace

Status read_input_file(const fs::path& path, std::uintmax_t limit_bytes, std::vector<unsigned char>& bytes) {
  bytes.clear();
  struct stat facts {};
  // Looked at before it is opened: to open a device may do something. O_NONBLOCK: what became a pipe
  // meanwhile, and files of the kernel that wait for news, must not hold us.
  if (::stat(path.c_str(), &facts) != 0) return failed(path, errno);
  if (Status status = judge(path, facts, limit_bytes); !status.ok()) return status;
  const OwnedDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (file.get() < 0 || ::fstat(file.get(), &facts) != 0) return failed(path, errno);
  if (Status status = judge(path, facts, limit_bytes); !status.ok()) return status;
  bytes.resize(static_cast<std::size_t>(facts.st_size));
  Status status = read_to_end(path, file.get(), limit_bytes, bytes);
  if (!status.ok()) bytes.clear();
  return status;
}

Status read_text_file(const fs::path& path, std::uintmax_t limit_bytes, std::string& text) {
  text.clear();
  std::vector<unsigned char> bytes;
  if (Status status = read_input_file(path, limit_bytes, bytes); !status.ok()) return status;
  std::string_view content(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  if (content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF"))
    return {StatusCode::kDamaged,
            fmt::format("{} is text in UTF-16; save it again as UTF-8 or plain ASCII", path.string())};
  text = content;
  return {};
}

}  // namespace plvo
