// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/stderr_log.hpp"

#include <cstdio>

namespace plvo {

void StderrLog::write(LogLevel level, std::string_view message) {
  const char* word = level == LogLevel::kError ? "error: " : level == LogLevel::kWarning ? "warning: " : "";
  std::fprintf(stderr, "plvo: %s%.*s\n", word, static_cast<int>(message.size()), message.data());
}

}  // namespace plvo
