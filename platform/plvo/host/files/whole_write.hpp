// SPDX-License-Identifier: Apache-2.0
// A text reaches a file whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

// Opens a file to write it anew, or standard output once more. A descriptor, or -1 and errno.
int open_output(const std::filesystem::path& path);

// Writes all of the text. Where a full disk or a limit on the size of files cuts it short, what is already at
// the end of a regular file is taken back; what a pipe or a terminal took stays. 0, or errno.
int write_whole(int descriptor, std::string_view text);

// kIo: "cannot write FILE: REASON; what to do". what: the verb. reason: errno.
Status output_failed(const char* what, const std::filesystem::path& path, int reason);

// "-", /dev/stdout and its other names.
bool is_standard_output(const std::filesystem::path& path);

}  // namespace plvo
