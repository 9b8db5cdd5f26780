// SPDX-License-Identifier: Apache-2.0
// How much memory something takes, in a process of its own: what was taken before does not hide it.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "plvo/host/files/reader_limits.hpp"

namespace plvo::test {

// What a sanitizer takes besides is more.
#if defined(__has_feature)
#define PLVO_TEST_HAS(feature) __has_feature(feature)
#else
#define PLVO_TEST_HAS(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || PLVO_TEST_HAS(address_sanitizer) || \
    PLVO_TEST_HAS(thread_sanitizer)
inline constexpr bool kMemoryIsTold = false;
#else
inline constexpr bool kMemoryIsTold = true;
#endif

// The most that is resident while `work` runs, beyond what was before; `work` says whether it went as it
// should.
inline void expect_within_the_ceiling(const char* what, const std::function<bool()>& work) {
  const auto peak_kib = [] {
    rusage use{};
    ::getrusage(RUSAGE_SELF, &use);
    return use.ru_maxrss;
  };
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const long before = peak_kib();
    const bool well = work();
    const long taken = well ? peak_kib() - before : -1;
    const ssize_t told = ::write(ends[1], &taken, sizeof taken);
    ::_exit(told == sizeof taken ? 0 : 1);
  }
  ::close(ends[1]);
  long taken_kib = -1;
  EXPECT_EQ(::read(ends[0], &taken_kib, sizeof taken_kib), static_cast<ssize_t>(sizeof taken_kib)) << what;
  ::close(ends[0]);
  int how = 0;
  ASSERT_EQ(::waitpid(child, &how, 0), child);
  EXPECT_TRUE(WIFEXITED(how) && WEXITSTATUS(how) == 0) << what;
  EXPECT_GE(taken_kib, 0) << what << ": not read, or not refused, as it should be";
  if (kMemoryIsTold) {
    EXPECT_LT(taken_kib, static_cast<long>(kMostReaderBytes / 1024)) << what;
  }
  testing::Test::RecordProperty(what, std::to_string(taken_kib / 1024) + " MiB");
}

}  // namespace plvo::test
