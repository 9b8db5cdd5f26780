// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, SIGTERM and a terminal that closes (SIGHUP) end a command's loop, not the program: what exists is
// written. A second Ctrl-C ends the program as usual.
#pragma once

namespace plvo::cli {

void catch_interrupt();
bool interrupted();

// From here on a reader that left and a file that may not grow are errors of write(), which say what
// happened, and no longer the end of the program.
void ignore_broken_outputs();

}  // namespace plvo::cli
