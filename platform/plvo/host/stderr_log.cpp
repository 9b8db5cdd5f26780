// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stderr_log.hpp"

#include <string>

#include "plvo/host/printable.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo {

void StderrLog::write(LogLevel level, std::string_view message) {
  const char* word = level == LogLevel::kError ? "error: " : level == LogLevel::kWarning ? "warning: " : "";
  print_to_stderr(std::string("plvo: ") + word + printable(message) + '\n');
}

}  // namespace plvo
