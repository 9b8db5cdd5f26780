// SPDX-License-Identifier: Apache-2.0
// Which files a command reads and which it writes, so that no output takes the place of an input or of
// another output, whatever names, links or relative paths they are given by.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace plvo::cli {

class FileRoles {
 public:
  // An empty path is no file.
  void reads(const std::filesystem::path& file);
  // option: how the user named it.
  void writes(const std::string& option, const std::filesystem::path& file);
  // A folder that gets files of which nobody chose the names.
  void writes_folder(const std::string& option, const std::filesystem::path& folder);

  // True where an output is there already: only then can it be an input.
  bool may_overwrite() const;
  // Refuses with exit code 2 (options/arguments.hpp), before anything is opened.
  void check() const;

 private:
  struct Output {
    std::string option;
    std::filesystem::path path;
  };
  void check_inputs(const Output& output) const;
  void check_folders() const;

  std::vector<std::filesystem::path> inputs_;
  std::vector<Output> outputs_, folders_;
};

}  // namespace plvo::cli
