// SPDX-License-Identifier: Apache-2.0
// plvo, the command line.
#include "plvo/cli/command_line.hpp"

int main(int argc, char** argv) { return plvo::cli::run_command_line(argc, argv); }
