// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/console.hpp"

#include <unistd.h>

#include <algorithm>

#include "plvo/host/files/whole_write.hpp"
#include "plvo/host/posix_clock.hpp"
#include "plvo/host/printable.hpp"
#include "plvo/host/stderr_log.hpp"

namespace plvo::cli {
namespace {

constexpr std::int64_t kPeriod_ns = 100'000'000;
const std::string kErase = "\r\033[K";      // the line of a terminal
constexpr std::size_t kKeptWarnings = 100;  // a session may last for weeks

}  // namespace

Console::Console(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void Console::write(LogLevel level, std::string_view message) {
  const std::lock_guard lock(mutex_);
  if ((quiet_ && level == LogLevel::kInfo) || message == last_) return;
  last_ = message;
  if (level != LogLevel::kInfo) keep(message);
  erase_line();
  StderrLog().write(level, message);
}

std::vector<std::string> Console::warnings() {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

// Under mutex_.
void Console::keep(std::string_view message) {
  if (warnings_.size() < kKeptWarnings &&
      std::find(warnings_.begin(), warnings_.end(), message) == warnings_.end())
    warnings_.emplace_back(message);
}

bool Console::wants_line() {
  if (quiet_ || !terminal_) return false;
  const std::lock_guard lock(mutex_);
  const std::int64_t now = posix_monotonic_ns();
  if (now < next_ns_) return false;
  next_ns_ = now + kPeriod_ns;
  return true;
}

void Console::show_line(std::string_view line) {
  const std::lock_guard lock(mutex_);
  write_whole(STDERR_FILENO, kErase + printable(line));
  shown_ = true;
}

void Console::clear() {
  const std::lock_guard lock(mutex_);
  erase_line();
}

// Under mutex_.
void Console::erase_line() {
  if (shown_) write_whole(STDERR_FILENO, kErase);
  shown_ = false;
}

}  // namespace plvo::cli
