// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/interrupt.hpp"

#include <csignal>

namespace plvo::cli {
namespace {

volatile std::sig_atomic_t caught = 0;
extern "C" void on_interrupt(int) { caught = 1; }

// Whether the program was started to outlive its terminal (nohup): then it must.
bool ignored_from_the_start(int signal) {
  struct sigaction before = {};
  return sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

}  // namespace

void catch_interrupt() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  // Without SA_RESTART: a read of the keyboard must end, too. A terminal that closes sends SIGHUP twice, by
  // way of the shell, and a supervisor may repeat itself: the files shall be whole then as well.
  sigaction(SIGTERM, &action, nullptr);
  if (!ignored_from_the_start(SIGHUP)) sigaction(SIGHUP, &action, nullptr);
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C ends the program at once
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() { return caught != 0; }

}  // namespace plvo::cli
