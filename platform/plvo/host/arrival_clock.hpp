// SPDX-License-Identifier: Apache-2.0
// What the clock of a camera showed at a moment of this computer's clock, told by when its frames arrive. A
// frame may be held up on its way, and never comes early: the frame that was the quickest, of those of the
// last ten to twenty seconds, counts. So clocks that drift apart, and a camera's that jumps, are followed.
#pragma once

#include <cstdint>
#include <optional>

namespace plvo {

class ArrivalClock {
 public:
  static constexpr std::int64_t kWindow_ns = 10'000'000'000;

  // least_delay_ns: from a frame's stamp to the arrival of a frame that nothing held up.
  explicit ArrivalClock(std::int64_t least_delay_ns) : least_delay_ns_(least_delay_ns) {}

  // host_ns: posix_monotonic_ns() when it came; of every frame, in order.
  void frame_arrived(std::int64_t stamp_ns, std::int64_t host_ns);

  // Returns nothing before the first frame.
  std::optional<std::int64_t> stamp_of(std::int64_t host_ns) const;

 private:
  std::int64_t least_delay_ns_;
  std::int64_t window_began_ns_ = 0;
  std::optional<std::int64_t> before_,
      now_;  // host minus stamp, the least of the last window and of this one
};

}  // namespace plvo
