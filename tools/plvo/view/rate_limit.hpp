// SPDX-License-Identifier: Apache-2.0
// Limits how much of a resource each address, and all of them together, may use per second: one token bucket
// for each address and one for all. The amount is subtracted after its use, so that a bucket may be overdrawn
// once; nothing more is allowed until the debt is repaid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace plvo {

class RateLimit {
 public:
  struct Bucket {
    std::int64_t unit_ns;   // time in which one unit is added
    std::int64_t depth_ns;  // capacity of the bucket, as the time in which it fills
  };
  RateLimit(const Bucket& address, const Bucket& all) : address_(address), all_(all) {}

  // Callable from any thread. Times are monotonic nanoseconds.
  bool allows(const std::string& address, std::int64_t now_ns) const;
  void spend(const std::string& address, std::int64_t units, std::int64_t now_ns);

  // An address is removed once its bucket is full again.
  std::size_t known_addresses() const;

 private:
  const Bucket address_, all_;
  mutable std::mutex mutex_;
  std::map<std::string, std::int64_t> full_at_ns_;  // by address: time at which its bucket is full
  std::int64_t all_full_at_ns_ = 0;
};

}  // namespace plvo
