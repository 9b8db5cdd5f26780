// SPDX-License-Identifier: Apache-2.0
// The subcommands of plvo. Each lives in its own file: it adds its options to the application and sets a
// callback that does the work when the subcommand was chosen and stores how it ended in exit_code:
//   void add_run(CLI::App& app, int& exit_code);
// command_line.cpp calls them all; adding one is a file, a declaration here and a line there.
#pragma once

#include "plvo/cli/options/arguments.hpp"

namespace plvo::cli {

void add_run(CLI::App& app, int& exit_code);
void add_calibrate(CLI::App& app, int& exit_code);
void add_eval(CLI::App& app, int& exit_code);
void add_live(CLI::App& app, int& exit_code);
void add_record(CLI::App& app, int& exit_code);
void add_convert(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_map(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);
void add_tilt(CLI::App& app, int& exit_code);
// After the others, which it describes.
void add_documentation(CLI::App& app, int& exit_code);

}  // namespace plvo::cli
