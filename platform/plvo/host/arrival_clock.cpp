// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/arrival_clock.hpp"

#include <algorithm>

namespace plvo {

void ArrivalClock::frame_arrived(std::int64_t stamp_ns, std::int64_t host_ns) {
  const std::int64_t difference_ns = host_ns - stamp_ns;
  if (!now_) window_began_ns_ = host_ns;
  if (host_ns - window_began_ns_ >= kWindow_ns) {
    window_began_ns_ = host_ns;
    before_ = now_;
    now_.reset();
  }
  now_ = std::min(now_.value_or(difference_ns), difference_ns);
}

std::optional<std::int64_t> ArrivalClock::stamp_of(std::int64_t host_ns) const {
  if (!now_) return {};
  return host_ns - std::min(*now_, before_.value_or(*now_)) + least_delay_ns_;
}

}  // namespace plvo
