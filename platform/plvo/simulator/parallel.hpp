// SPDX-License-Identifier: Apache-2.0
// Distributes bands of image rows over threads; each free thread takes the next band. The result of the work
// must not depend on the thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace plvo::sim {

constexpr int kThreadRows = 16;  // rows that a thread takes at a time

// Calls work(begin, end) for bands of at most `band` rows; the bands cover 0 … rows−1 exactly once.
template <typename Work>
void for_rows(int threads, int rows, int band, const Work& work) {
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int begin = next.fetch_add(band); begin < rows; begin = next.fetch_add(band))
      work(begin, std::min(begin + band, rows));
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < threads; ++i) {
    try {
      helpers.emplace_back(run);
    } catch (const std::system_error&) {
      break;  // no further thread is available: the existing ones do the work
    }
  }
  run();
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace plvo::sim
