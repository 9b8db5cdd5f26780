// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/background.hpp"

#include <sys/resource.h>

namespace plvo {

// Linux gives each thread a priority of its own, and 0 means the calling one. To yield is always allowed.
void run_in_background() {
  constexpr int kLowest = 19;
  ::setpriority(PRIO_PROCESS, 0, kLowest);
}

}  // namespace plvo
