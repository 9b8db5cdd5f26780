// SPDX-License-Identifier: Apache-2.0
// Rows of an image shared out among threads, in bands, to whoever is free. The work must not depend on who
// does it.
#pragma once

#include <algorithm>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace plvo::sim {

constexpr int kThreadRows = 16;  // rows a thread takes at a time

// Calls work(begin, end) for bands of at most `band` rows that cover 0 … rows−1 once.
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
      break;  // the machine has no thread to spare: the ones there are do the work
    }
  }
  run();
  for (std::thread& helper : helpers) helper.join();
}

}  // namespace plvo::sim
