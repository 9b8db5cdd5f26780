// SPDX-License-Identifier: Apache-2.0
// Measures the stack usage. The stack is filled with a pattern at the start; bytes that still contain it were
// never used.
#pragma once

#include <cstddef>

namespace plvo::bare_metal {

// Paints from the stack's end up to the caller; bytes used before this call count as unused.
void paint_stack();

// Bytes from the stack's top down to the lowest one that was written since it was painted.
std::size_t deepest_stack_bytes();

// Bytes from the stack's top down to the caller.
std::size_t current_stack_bytes();

// Size of the whole stack, from the linker script.
std::size_t stack_bytes();

}  // namespace plvo::bare_metal
