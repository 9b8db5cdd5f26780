// SPDX-License-Identifier: Apache-2.0
// plvo as a function: a list of subcommands and nothing else. The program is one call of it; a test that
// brings its own USB bus calls it in its own process.
#pragma once

namespace plvo::cli {

// What main() returns.
int run_command_line(int argc, const char* const* argv);

}  // namespace plvo::cli
