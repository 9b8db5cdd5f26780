// SPDX-License-Identifier: Apache-2.0
// Whole files into memory, with a bound: what somebody else wrote is read only where it is a regular file of
// a size that such a file can have. Pipes, devices, folders, files that never end and files with holes of
// gigabytes are refused before a byte is allocated for them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"

namespace plvo {

inline constexpr std::uintmax_t kMaxTextBytes =
    64u << 20;  // a list or a table of a day at 30 Hz has a tenth of it

// kNotFound: no such file; kPermission; kInvalidArgument: not a regular file, or more than `limit_bytes`;
// kIo. The message names the path. `bytes` keeps its capacity, so that a buffer which was large enough once
// is not reallocated; on failure it is empty.
Status read_input_file(const std::filesystem::path& path, std::uintmax_t limit_bytes,
                       std::vector<unsigned char>& bytes);

// The same as UTF-8 text. A byte order mark is taken off; UTF-16 and UTF-32 are refused (kDamaged).
Status read_text_file(const std::filesystem::path& path, std::uintmax_t limit_bytes, std::string& text);

}  // namespace plvo
