// SPDX-License-Identifier: Apache-2.0
// Ctrl-C ends a command's loop, not the program: what exists is written. A second one ends the program as
// usual.
#pragma once

namespace plvo::cli {

void catch_interrupt();
bool interrupted();

}  // namespace plvo::cli
