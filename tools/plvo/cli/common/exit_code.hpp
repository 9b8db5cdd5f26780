// SPDX-License-Identifier: Apache-2.0
// How every subcommand of plvo ends: data goes to standard output, messages to standard error, and the exit
// code says what happened.
#pragma once

#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo::cli {

inline constexpr int kExitSuccess = 0;
inline constexpr int kExitFailure = 1;         // an input is missing or broken, an output cannot be written
inline constexpr int kExitUsage = 2;           // the command line itself is wrong
inline constexpr int kExitNothingTracked = 3;  // everything was read, but no frame could be tracked
inline constexpr int kExitNoSensor = 4;  // no sensor that can be used, or it went away and did not come back

// Ends of the help text.
inline constexpr const char* kExitCodeHelp =
    "Exit codes: 0 success; 1 an input is missing or broken, or an output cannot be written;\n"
    "            2 wrong usage; 3 no frame could be tracked; 4 no sensor that can be used.";

// One line on standard error, "plvo: error: …". Returns kExitFailure, so that a command can end with it.
int fail(const Status& status);
int fail(std::string_view message);
void warn(std::string_view message);

}  // namespace plvo::cli
