// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, SIGTERM and a terminal that closes (SIGHUP) end a command's loop, not the program: what exists is
// written. A second Ctrl-C ends the program as usual.
#pragma once

namespace plvo::cli {

void catch_interrupt();
bool interrupted();

}  // namespace plvo::cli
