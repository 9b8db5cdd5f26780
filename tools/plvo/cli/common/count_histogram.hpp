// SPDX-License-Identifier: Apache-2.0
// The median of any number of small counts in fixed memory: one bin for each count, the last for
// all larger ones.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace plvo::cli {

class CountHistogram {
 public:
  void add(int count) {
    ++bins_[static_cast<std::size_t>(std::clamp(count, 0, static_cast<int>(bins_.size()) - 1))];
    ++total_;
  }
  // The lower one of the two in the middle; 0 when there is none.
  int median() const {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      below += bins_[i];
      if (total_ > 0 && 2 * below >= total_) return static_cast<int>(i);
    }
    return 0;
  }

 private:
  std::array<std::uint64_t, 4096> bins_{};
  std::uint64_t total_ = 0;
};

}  // namespace plvo::cli
