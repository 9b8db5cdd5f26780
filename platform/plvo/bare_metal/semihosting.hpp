// SPDX-License-Identifier: Apache-2.0
// Arm's semihosting (Arm IHI 0100, "Semihosting for AArch32 and AArch64"): text output, files and an exit
// code through the debugger or the emulator. For tests and first steps on a board; every call halts the
// processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace plvo::bare_metal {

// Writes to the host's standard output.
void write_text(std::string_view text);

// A file of the host, opened for reading; handle() is −1 if it does not exist.
class HostFile {
 public:
  // path: terminated by a zero byte.
  explicit HostFile(const char* path);
  ~HostFile();
  HostFile(const HostFile&) = delete;
  HostFile& operator=(const HostFile&) = delete;

  bool ok() const { return handle_ != -1; }
  // Returns true if all of `bytes` was filled.
  bool read(std::span<std::byte> bytes);

 private:
  std::int32_t handle_;
};

// Ends the emulator with this exit code; under a debugger, execution stops here.
[[noreturn]] void exit(int code);

}  // namespace plvo::bare_metal
