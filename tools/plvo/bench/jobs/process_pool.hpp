// SPDX-License-Identifier: Apache-2.0
// Runs command lines as child processes, a few at a time, in order.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace plvo::bench {

// Called when command `index` has ended, with how many have by then.
using CommandEnded = std::function<void(std::size_t index, bool success, std::size_t ended)>;

// Standard output of the children goes to standard error. Returns how many failed: a failure stops nobody
// else. An interrupt (Ctrl-C) reaches the children through the terminal as well.
std::size_t run_commands(const std::vector<std::vector<std::string>>& commands, int at_a_time,
                         const CommandEnded& ended);

// This program, for commands that call it.
std::string own_program();

}  // namespace plvo::bench
