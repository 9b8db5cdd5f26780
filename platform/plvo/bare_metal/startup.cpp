// SPDX-License-Identifier: Apache-2.0
// Startup code from reset to main() on a Cortex-M7: enables floating point, initialises variables, paints the
// stack, and exits after main(). There is no heap, and no objects are destroyed.
#include <cstddef>
#include <cstdint>

#include "plvo/bare_metal/semihosting.hpp"
#include "plvo/bare_metal/stack_paint.hpp"

extern "C" {

// Defined in the linker script.
extern std::uint32_t plvo_data_load[], plvo_data_begin[], plvo_data_end[];
extern std::uint32_t plvo_bss_begin[], plvo_bss_end[];
extern std::uint32_t plvo_stack_top[];
extern void (*plvo_init_array_begin[])();
extern void (*plvo_init_array_end[])();

int main();

[[noreturn]] void plvo_start() {
  // Enables full access to the floating-point unit (coprocessors 10 and 11) before its first instruction.
  *reinterpret_cast<volatile std::uint32_t*>(0xe000ed88) |= 0xfU << 20;
  asm volatile("dsb\n isb" ::: "memory");
  for (std::uint32_t *to = plvo_data_begin, *from = plvo_data_load; to != plvo_data_end; ++to, ++from)
    *to = *from;
  for (std::uint32_t* to = plvo_bss_begin; to != plvo_bss_end; ++to) *to = 0;
  for (auto construct = plvo_init_array_begin; construct != plvo_init_array_end; ++construct) (*construct)();
  plvo::bare_metal::paint_stack();
  plvo::bare_metal::exit(main());
}

[[noreturn]] void plvo_reset() { plvo_start(); }

// Handles all processor exceptions, e.g. an access to unmapped memory or an undefined instruction.
[[noreturn]] void plvo_fault() {
  plvo::bare_metal::write_text("stopped by a fault of the processor\n");
  plvo::bare_metal::exit(3);
}

// The system timer's interrupt; systick_clock.cpp overrides it in programs that use that clock.
[[gnu::weak]] void plvo_systick() { plvo_fault(); }

// A call of a pure virtual function is a programming error.
[[noreturn]] void __cxa_pure_virtual() { plvo_fault(); }
// Referenced by the unwinding tables of the compiler's own library, which the linker script discards.
void __aeabi_unwind_cpp_pr0() {}

}  // extern "C"

namespace {

struct VectorTable {
  const std::uint32_t* stack_top;
  void (*handlers[15])();
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable kVectors = {
    plvo_stack_top,
    {plvo_reset, plvo_fault, plvo_fault, plvo_fault, plvo_fault, plvo_fault, nullptr, nullptr, nullptr,
     nullptr, plvo_fault, plvo_fault, nullptr, plvo_fault, plvo_systick}};

}  // namespace
