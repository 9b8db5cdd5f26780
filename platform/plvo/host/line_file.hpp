// SPDX-License-Identifier: Apache-2.0
// A text file that is valid at every moment: each line reaches the operating system whole before write()
// returns, and a line that a full disk cuts short is taken back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

class LineFile {
 public:
  LineFile() = default;
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  ~LineFile() { close(); }

  // Makes the file or empties it. kIo, with the operating system's reason and the path.
  Status open(const std::filesystem::path& path);
  // The same, and writes the first line.
  Status open(const std::filesystem::path& path, std::string_view first_line);
  // line: without its newline. kIo as above; the lines before it stay. A file that is not open takes any line
  // and does nothing, so that an output nobody asked for needs no special case.
  Status write(std::string_view line);
  void close();
  bool is_open() const { return descriptor_ >= 0; }

 private:
  Status failed(const char* what) const;

  std::filesystem::path path_;
  std::string line_;
  int descriptor_ = -1;
  std::int64_t length_ = 0;  // bytes of whole lines
};

}  // namespace plvo
