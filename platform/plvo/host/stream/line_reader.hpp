// SPDX-License-Identifier: Apache-2.0
// Lines of a writer that may be slow, stalled or gone, without ever waiting for it: standard input, a named
// pipe, a serial port or a file. A line counts when its newline has come.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

class LineReader {
 public:
  static constexpr std::size_t kLongestLine = 4096;  // a longer one is cut there

  LineReader() = default;
  ~LineReader();
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  // path: "-" is standard input. A named pipe needs no writer yet. Returns kNotFound, kPermission, kIo, and
  // kInvalidArgument for a folder.
  Status open(const std::string& path);
  bool is_open() const { return descriptor_ >= 0; }

  // The next line that has come whole, without its newline; false if there is none now.
  bool next(std::string& line);

  // The writer has left, or the device. A named pipe may get another writer.
  bool ended() const { return ended_; }

 private:
  bool read_some();

  int descriptor_ = -1;
  bool owned_ = false;
  bool ended_ = false;
  bool cut_ = false;  // the rest of a line that was too long is passed over
  std::string buffer_;
};

}  // namespace plvo
