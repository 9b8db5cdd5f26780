// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/resident_memory.hpp"

#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <memory>

#ifndef MADV_POPULATE_READ
#define MADV_POPULATE_READ 22  // Linux 5.14; older C libraries do not name it
#endif

namespace plvo::cli {
namespace {

constexpr std::size_t kStackBytes = 256 * 1024;

int populate_segments(dl_phdr_info* object, std::size_t, void*) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const auto& segment = object->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD) continue;
    const std::uintptr_t begin = (object->dlpi_addr + segment.p_vaddr) / page * page;
    const std::uintptr_t end =
        (object->dlpi_addr + segment.p_vaddr + segment.p_memsz + page - 1) / page * page;
    madvise(reinterpret_cast<void*>(begin), end - begin, MADV_POPULATE_READ);
  }
  return 0;
}

[[gnu::noinline]] char touch_stack() {
  volatile char stack[kStackBytes];
  for (std::size_t i = 0; i < kStackBytes; i += 1024) stack[i] = 0;
  return stack[0];
}

// Half a mebibyte at the end of the heap, there to stay: what the image libraries take and give back for
// every image lies now here, now there, and would pass for growth.
void touch_heap() {
  constexpr std::size_t kBlockBytes = 64 * 1024;
  mallopt(M_TRIM_THRESHOLD, 4 * 1024 * 1024);
  std::array<std::unique_ptr<char[]>, 8> blocks;
  for (std::unique_ptr<char[]>& block : blocks) block = std::make_unique<char[]>(kBlockBytes);  // set to zero
}

}  // namespace

ResidentMemory resident_memory() {
  std::ifstream stream("/proc/self/statm");
  std::int64_t size = 0, resident = 0, shared = 0;
  if (!(stream >> size >> resident >> shared)) return {};
  const std::int64_t page = sysconf(_SC_PAGESIZE);
  return {resident * page, (resident - shared) * page};
}

void prefault_program() {
  dl_iterate_phdr(populate_segments, nullptr);
  touch_stack();
  touch_heap();
  (void)resident_memory();
}

}  // namespace plvo::cli
