// SPDX-License-Identifier: Apache-2.0
// The clock of a POSIX machine: CLOCK_MONOTONIC, which neither jumps nor stops while the machine runs.
#pragma once

#include "plvo/hal/clock.hpp"

namespace plvo {

class PosixClock final : public Clock {
 public:
  std::int64_t monotonic_ns() const override;
  void sleep_until_ns(std::int64_t monotonic_ns) override;
};

// The same clock as a plain function.
std::int64_t posix_monotonic_ns();
// Processor time of the calling thread, for Config::stage_clock.
std::int64_t posix_thread_cpu_ns();
// Processor time of all threads of this process.
std::int64_t posix_process_cpu_ns();

}  // namespace plvo
