// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/posix_clock.hpp"

#include <cerrno>
#include <ctime>

namespace plvo {
namespace {

std::int64_t read_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

std::int64_t posix_monotonic_ns() { return read_ns(CLOCK_MONOTONIC); }
std::int64_t posix_thread_cpu_ns() { return read_ns(CLOCK_THREAD_CPUTIME_ID); }
std::int64_t posix_process_cpu_ns() { return read_ns(CLOCK_PROCESS_CPUTIME_ID); }

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
