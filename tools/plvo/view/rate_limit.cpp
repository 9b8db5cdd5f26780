// SPDX-License-Identifier: Apache-2.0
#include "plvo/view/rate_limit.hpp"

#include <algorithm>

namespace plvo {

bool RateLimit::allows(const std::string& address, std::int64_t now_ns) const {
  const std::lock_guard lock(mutex_);
  if (all_full_at_ns_ - now_ns >= all_.depth_ns) return false;
  const auto found = full_at_ns_.find(address);
  return found == full_at_ns_.end() || found->second - now_ns < address_.depth_ns;
}

void RateLimit::spend(const std::string& address, std::int64_t units, std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  std::erase_if(full_at_ns_, [now_ns](const auto& one) { return one.second <= now_ns; });
  std::int64_t& full_at_ns = full_at_ns_[address];
  full_at_ns = std::max(full_at_ns, now_ns) + units * address_.unit_ns;
  all_full_at_ns_ = std::max(all_full_at_ns_, now_ns) + units * all_.unit_ns;
}

std::size_t RateLimit::known_addresses() const {
  const std::lock_guard lock(mutex_);
  return full_at_ns_.size();
}

}  // namespace plvo
