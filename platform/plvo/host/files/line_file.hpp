// SPDX-License-Identifier: Apache-2.0
// A text file that is valid at every moment: each line reaches the operating system whole before write()
// returns, and a line that a full disk cuts short is taken back (whole_write.hpp). The name "-" is standard
// output.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/host/files/whole_write.hpp"

namespace plvo {

class LineFile {
 public:
  LineFile() = default;
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  ~LineFile() { close(); }

  // Makes the file or empties it; standard output goes on where it is. kIo, with the operating system's
  // reason and the path.
  Status open(const std::filesystem::path& path);
  // The same, and writes the first line.
  Status open(const std::filesystem::path& path, std::string_view first_line);
  // line: without its newline. kIo as above; the lines before it stay. A file that is not open takes any line
  // and does nothing, so that an output nobody asked for needs no special case.
  Status write(std::string_view line);
  void close();
  bool is_open() const { return descriptor_ >= 0; }

  // What open() would say, without touching what the file holds; for a file that is written at the end of
  // a long run.
  static Status check(const std::filesystem::path& path);

 private:
  std::filesystem::path path_;
  std::string line_;
  int descriptor_ = -1;
};

}  // namespace plvo
