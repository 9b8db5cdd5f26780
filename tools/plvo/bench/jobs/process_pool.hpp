// SPDX-License-Identifier: Apache-2.0
// Runs command lines as child processes in order, a limited number at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace plvo::bench {

// Called when command `index` has ended; `ended` counts the finished commands.
using CommandEnded = std::function<void(std::size_t index, bool success, std::size_t ended)>;

// Redirects standard output of the children to standard error. Returns the number of failures; a failure does
// not stop the other commands. The terminal sends an interrupt (Ctrl-C) to the children as well.
std::size_t run_commands(const std::vector<std::vector<std::string>>& commands, int at_a_time,
                         const CommandEnded& ended);

// Returns the path of this program, for commands that call it.
std::string own_program();

}  // namespace plvo::bench
