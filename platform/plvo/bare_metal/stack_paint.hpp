// SPDX-License-Identifier: Apache-2.0
// How deep the stack has been: painted at the start, read when asked. The bytes that still carry the paint
// were never used.
#pragma once

#include <cstddef>

namespace plvo::bare_metal {

// From the stack's end up to here; whatever was used before counts as unused.
void paint_stack();

// Bytes from the stack's top down to the lowest one that was written since it was painted.
std::size_t deepest_stack_bytes();

// Bytes from the stack's top down to the caller.
std::size_t current_stack_bytes();

// The whole of it, as the linker script has it.
std::size_t stack_bytes();

}  // namespace plvo::bare_metal
