// SPDX-License-Identifier: Apache-2.0
#include "plvo/bare_metal/stack_paint.hpp"

#include <cstdint>

extern "C" {
extern std::uint32_t plvo_stack_bottom[], plvo_stack_top[];
}

namespace plvo::bare_metal {
namespace {

constexpr std::uint32_t kPaint = 0xa5c3f00d;
// Bytes that are not painted, next to paint_stack's own frame.
constexpr std::size_t kMargin = 64;

}  // namespace

[[gnu::noinline]] void paint_stack() {
  std::uint32_t* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0));
  // volatile keeps the compiler from calling memset, whose frame would lie in the painted area.
  for (volatile std::uint32_t* word = plvo_stack_bottom; word < here - kMargin / sizeof *word; ++word)
    *word = kPaint;
}

std::size_t deepest_stack_bytes() {
  const volatile std::uint32_t* word = plvo_stack_bottom;
  while (word < plvo_stack_top && *word == kPaint) ++word;
  return static_cast<std::size_t>(plvo_stack_top - word) * sizeof *word;
}

[[gnu::noinline]] std::size_t current_stack_bytes() {
  const std::uint32_t* const here = static_cast<std::uint32_t*>(__builtin_frame_address(0));
  return static_cast<std::size_t>(plvo_stack_top - here) * sizeof *here;
}

std::size_t stack_bytes() {
  return static_cast<std::size_t>(plvo_stack_top - plvo_stack_bottom) * sizeof *plvo_stack_top;
}

}  // namespace plvo::bare_metal
