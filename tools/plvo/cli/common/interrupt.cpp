// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/interrupt.hpp"

#include <csignal>

namespace plvo::cli {
namespace {

volatile std::sig_atomic_t caught = 0;
extern "C" void on_interrupt(int) { caught = 1; }

}  // namespace

void catch_interrupt() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  action.sa_flags =
      static_cast<int>(SA_RESETHAND);  // and no SA_RESTART: a read of the keyboard must end, too
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return caught != 0; }

void ignore_broken_outputs() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace plvo::cli
