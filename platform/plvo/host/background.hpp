// SPDX-License-Identifier: Apache-2.0
// Work that runs only when the processor is otherwise idle.
#pragma once

namespace plvo {

// The calling thread, and those that it starts from now on, yield to others: under Linux with the lowest of
// the priorities that leave a thread a little time (nice 19, about a hundredth of a contended core). It
// cannot be taken back. A thread that other threads wait for should not be one of these.
void run_in_background();

}  // namespace plvo
