// SPDX-License-Identifier: Apache-2.0
// Standard output and standard error of a program. All text for people passes here, and what in it comes from
// outside cannot command the terminal (printable.hpp).
#pragma once

#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo {

// Descriptors 0 to 2 that the caller closed are taken, so that no file that is opened later gets one of them
// and messages into its data. Writing to them fails.
void hold_standard_streams();

// From here on a reader that left (SIGPIPE) and a file that may not grow (SIGXFSZ) are errors of write(),
// which say what happened, and no longer the end of the program.
void ignore_broken_outputs();

// Lines on standard output. kIo with the operating system's reason.
Status print(std::string_view text);

// Lines on standard error. A failure is not reported.
void print_to_stderr(std::string_view text);

}  // namespace plvo
