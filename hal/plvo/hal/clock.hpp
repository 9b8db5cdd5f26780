// SPDX-License-Identifier: Apache-2.0
// Time for waiting and measuring. The core itself reads no clock; its results depend only on the frames.
#pragma once

#include <cstdint>

namespace plvo {

class Clock {
 public:
  virtual std::int64_t monotonic_ns() const = 0;
  virtual void sleep_until_ns(std::int64_t monotonic_ns) = 0;

 protected:
  // Never deleted through the interface: a virtual destructor would require operator delete on every board.
  ~Clock() = default;
};

}  // namespace plvo
