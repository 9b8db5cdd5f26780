// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/posix_clock.hpp"

#include <cerrno>
#include <ctime>

namespace plvo {

std::int64_t posix_monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

std::int64_t PosixClock::monotonic_ns() const { return posix_monotonic_ns(); }

void PosixClock::sleep_until_ns(std::int64_t monotonic_ns) {
  if (monotonic_ns <= 0) return;
  timespec when{};
  when.tv_sec = static_cast<time_t>(monotonic_ns / 1'000'000'000);
  when.tv_nsec = static_cast<long>(monotonic_ns % 1'000'000'000);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

}  // namespace plvo
