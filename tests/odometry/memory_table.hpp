// SPDX-License-Identifier: Apache-2.0
// docs/memory.md, written from what an Odometry says of its own block.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plvo/odometry/odometry.hpp"

namespace plvo {

// What one choice of Limits takes.
struct MemoryUse {
  Limits limits;
  struct Row {
    std::string who;
    std::size_t bytes;
  };
  std::vector<Row> rows;     // of init, in the order of the carving
  std::size_t used = 0;      // by init; the sum of the rows
  std::size_t peak = 0;      // with the scratch of the hungriest frame so far
  std::size_t required = 0;  // what required_bytes asks of the caller
};

// What each choice may take at most, in all.
inline constexpr std::size_t kVgaCeiling = 7 * 512 * 1024, kQvgaCeiling = 704 * 1024,
                             kTinyCeiling = 512 * 1024;

// Tracks a few frames of the procedural sequence and reads the records.
MemoryUse measure_memory(const Limits& limits, const Config& config, int frames);

// The page, in Markdown, up to the heading of what is not written by a test.
inline constexpr const char* kMemoryPageEnd = "\n## Tiny\n";
std::string memory_page(const std::array<MemoryUse, 3>& vga_qvga_tiny);

}  // namespace plvo
