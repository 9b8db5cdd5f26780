// SPDX-License-Identifier: Apache-2.0
// Writes docs/developer/memory.md from the memory records of an Odometry.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plvo/odometry/odometry.hpp"

namespace plvo {

// Memory of an Odometry with one choice of Limits.
struct MemoryUse {
  Limits limits;
  struct Row {
    std::string who;
    std::size_t bytes;
  };
  std::vector<Row> rows;     // of init, in the order of allocation
  std::size_t used = 0;      // by init; the sum of the rows
  std::size_t peak = 0;      // with the largest scratch of any frame so far
  std::size_t required = 0;  // result of required_bytes
};

// Ceilings of the total memory for each choice of Limits.
inline constexpr std::size_t kVgaCeiling = 7 * 512 * 1024, kQvgaCeiling = 704 * 1024,
                             kTinyCeiling = 512 * 1024;

// Tracks a few frames of the procedural sequence and reads the records.
MemoryUse measure_memory(const Limits& limits, const Config& config, int frames);

// docs/developer/memory.md, in Markdown, up to the heading of the part that no test writes.
inline constexpr const char* kMemoryPageEnd = "\n## Stack\n";
std::string memory_page(const std::array<MemoryUse, 3>& vga_qvga_tiny);

}  // namespace plvo
