// SPDX-License-Identifier: Apache-2.0
// Standard error while a command works, from any thread: messages in whole lines, and below them, on
// a terminal only, a line of progress that is written over. A message that repeats the one before it
// is shown once.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/hal/log.hpp"

namespace plvo::cli {

class Console final : public Log {
 public:
  // quiet: warnings and errors alone.
  explicit Console(bool quiet);
  ~Console() { clear(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void write(LogLevel level, std::string_view message) override;
  // The warnings and errors so far, each once; of very many the first.
  std::vector<std::string> warnings();
  // True when a line would be shown now: ten times a second at most, so that nobody builds it in vain.
  bool wants_line();
  void show_line(std::string_view line);
  void clear();

 private:
  void erase_line();
  void keep(std::string_view message);

  std::mutex mutex_;
  const bool quiet_;
  const bool terminal_;
  bool shown_ = false;
  std::int64_t next_ns_ = 0;
  std::string last_;
  std::vector<std::string> warnings_;
};

}  // namespace plvo::cli
