// SPDX-License-Identifier: Apache-2.0
// How much of something each address, and all of them together, may have a second: a token bucket for each
// address and one for all. What is taken is counted afterwards, so that a bucket may be overdrawn once; then
// nothing is allowed until it is out of debt.
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
    std::int64_t unit_ns;   // one more unit every so often
    std::int64_t depth_ns;  // what was not used for so long can be taken at once
  };
  RateLimit(const Bucket& address, const Bucket& all) : address_(address), all_(all) {}

  // From any thread. Time is monotonic nanoseconds.
  bool allows(const std::string& address, std::int64_t now_ns) const;
  void spend(const std::string& address, std::int64_t units, std::int64_t now_ns);

  // An address is forgotten once its bucket is full again.
  std::size_t known_addresses() const;

 private:
  const Bucket address_, all_;
  mutable std::mutex mutex_;
  std::map<std::string, std::int64_t> full_at_ns_;  // by address: when its bucket will be full
  std::int64_t all_full_at_ns_ = 0;
};

}  // namespace plvo
