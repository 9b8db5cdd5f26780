// SPDX-License-Identifier: Apache-2.0
// Instructions of plvo's stages, counted by valgrind's callgrind: the same in every run, however busy the
// machine is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/table.hpp"

namespace plvo::bench {

// Runs `command`, which tracks through track_counted, under callgrind; its profile stays in out for
// callgrind_annotate. kNotFound without valgrind.
Status count_instructions(const std::vector<std::string>& command, const std::filesystem::path& out,
                          const std::string& name, std::size_t frames, Table& table);

}  // namespace plvo::bench
