// SPDX-License-Identifier: Apache-2.0
// How much memory this process holds, and how to hold it from the start.
#pragma once

#include <cstdint>

namespace plvo {

// Bytes; zero where the system does not tell. Anonymous is the part that no file backs: what the
// program itself took.
struct ResidentMemory {
  std::int64_t total = 0;
  std::int64_t anonymous = 0;
};
ResidentMemory resident_memory();

// The most that was resident at once since the start, or since it was last forgotten (Linux
// alone can forget).
std::int64_t peak_resident_bytes();
void forget_peak_resident();

constexpr double mebibytes(auto bytes) { return static_cast<double>(bytes) / (1024.0 * 1024.0); }

// Brings every page of the program, its libraries, its stack and a piece of its heap into memory now: the
// first frames then wait for no disk, and what grows later grew because something was taken. Does what the
// kernel can (Linux 5.14 for the code).
// And reads resident_memory() once: the first reading takes what reading needs.
void prefault_program();

}  // namespace plvo
