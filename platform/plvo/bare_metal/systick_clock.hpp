// SPDX-License-Identifier: Apache-2.0
// A Clock on the SysTick timer of the Cortex-M: it counts 1000 interrupts per second and reads the timer
// between them. Only one object may exist at a time.
#pragma once

#include <cstdint>

#include "plvo/hal/clock.hpp"

namespace plvo::bare_metal {

class SystickClock final : public Clock {
 public:
  // Starts the timer. processor_hz: frequency of the timer, 1 kHz … 16 GHz.
  explicit SystickClock(std::uint32_t processor_hz);

  std::int64_t monotonic_ns() const override;
  void sleep_until_ns(std::int64_t monotonic_ns) override;

 private:
  std::uint32_t ticks_per_ms_;
};

}  // namespace plvo::bare_metal
