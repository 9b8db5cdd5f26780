// SPDX-License-Identifier: Apache-2.0
// The pair of threads behind thread_pair.h.
#include "plvo/c/thread_pair.h"

#include <memory>

#include "plvo/c/guarded.hpp"
#include "plvo/host/thread_pair.hpp"

struct plvo_thread_pair {
  plvo::ThreadPair threads;
};

plvo_status plvo_thread_pair_start(plvo_thread_pair** pair) {
  return plvo::c::guarded([&]() -> plvo::Status {
    if (pair == nullptr) return plvo::c::missing("pair");
    *pair = nullptr;
    *pair = std::make_unique<plvo_thread_pair>().release();
    return {};
  });
}

void plvo_thread_pair_run(void* pair, plvo_task here, plvo_task beside) {
  static_cast<plvo_thread_pair*>(pair)->threads.run({here.call, here.context}, {beside.call, beside.context});
}

std::int64_t plvo_thread_pair_cpu_ns(const plvo_thread_pair* pair) {
  return pair == nullptr ? 0 : pair->threads.cpu_ns();
}

void plvo_thread_pair_stop(plvo_thread_pair* pair) { delete pair; }
