// SPDX-License-Identifier: Apache-2.0
// How many times a second something happens, over the last second or so. Fixed memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace plvo::cli {

class RateMeter {
 public:
  void tick(std::int64_t now_ns) {
    stamps_[next_] = now_ns;
    next_ = (next_ + 1) % stamps_.size();
    if (count_ < stamps_.size()) ++count_;
  }
  // Zero once nothing has happened for a second.
  double hz(std::int64_t now_ns) const {
    if (count_ < 2) return 0;
    const std::int64_t last = stamps_[(next_ + stamps_.size() - 1) % stamps_.size()];
    const std::int64_t first = stamps_[(next_ + stamps_.size() - count_) % stamps_.size()];
    if (now_ns - last > 1'000'000'000 || last <= first) return 0;
    return static_cast<double>(count_ - 1) * 1e9 / static_cast<double>(last - first);
  }

 private:
  std::array<std::int64_t, 32> stamps_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace plvo::cli
