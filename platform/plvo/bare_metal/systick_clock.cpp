// SPDX-License-Identifier: Apache-2.0
// Registers: Armv7-M Architecture Reference Manual, B3.3 "The system timer, SysTick".
#include "plvo/bare_metal/systick_clock.hpp"

namespace plvo::bare_metal {
namespace {

volatile std::uint32_t& reg(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
constexpr std::uintptr_t kControl = 0xe000e010, kReload = 0xe000e014, kCurrent = 0xe000e018;

volatile std::uint32_t milliseconds_low = 0;
volatile std::uint32_t milliseconds_high = 0;

}  // namespace

SystickClock::SystickClock(std::uint32_t processor_hz) : ticks_per_ms_(processor_hz / 1000) {
  reg(kReload) = ticks_per_ms_ - 1;
  reg(kCurrent) = 0;
  reg(kControl) = 7;  // processor clock, interrupts enabled, running
}

std::int64_t SystickClock::monotonic_ns() const {
  std::uint32_t high = 0, low = 0, left = 0;
  do {  // repeats if an interrupt occurred in between
    high = milliseconds_high;
    low = milliseconds_low;
    left = reg(kCurrent);
  } while (low != milliseconds_low);
  const auto milliseconds = static_cast<std::int64_t>((static_cast<std::uint64_t>(high) << 32) | low);
  const std::uint64_t within =
      static_cast<std::uint64_t>(ticks_per_ms_ - 1 - left) * 1'000'000 / ticks_per_ms_;
  return milliseconds * 1'000'000 + static_cast<std::int64_t>(within);
}

void SystickClock::sleep_until_ns(std::int64_t wake_ns) {
  while (monotonic_ns() < wake_ns) asm volatile("wfi");
}

}  // namespace plvo::bare_metal

// The interrupt handler, referenced by the vector table of startup.cpp.
extern "C" void plvo_systick() {
  using namespace plvo::bare_metal;
  const std::uint32_t next = milliseconds_low + 1;
  if (next == 0) milliseconds_high = milliseconds_high + 1;
  milliseconds_low = next;
}
