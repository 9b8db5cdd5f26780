// SPDX-License-Identifier: Apache-2.0
// A Clock on the SysTick timer that every Cortex-M has: a thousand interrupts a second, and what the timer
// counts between them. One object at a time.
#pragma once

#include <cstdint>

#include "plvo/hal/clock.hpp"

namespace plvo::bare_metal {

class SystickClock final : public Clock {
 public:
  // processor_hz: what the timer counts, 1 kHz … 16 GHz; starts it.
  explicit SystickClock(std::uint32_t processor_hz);

  std::int64_t monotonic_ns() const override;
  void sleep_until_ns(std::int64_t monotonic_ns) override;

 private:
  std::uint32_t ticks_per_ms_;
};

}  // namespace plvo::bare_metal
