// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>

#include "plvo/host/files/whole_write.hpp"
#include "plvo/host/printable.hpp"

namespace plvo {

void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest free descriptor is this one, since those below it are open.
    [[maybe_unused]] const int taken = ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

void ignore_broken_outputs() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

Status print(std::string_view text) {
  const int reason = write_whole(STDOUT_FILENO, printable_lines(text));
  return reason == 0 ? Status() : output_failed("write", "-", reason);
}

void print_to_stderr(std::string_view text) { write_whole(STDERR_FILENO, printable_lines(text)); }

}  // namespace plvo
