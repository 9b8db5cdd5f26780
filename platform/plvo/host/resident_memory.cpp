// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/resident_memory.hpp"

#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <memory>
#include <string>

#ifndef MADV_POPULATE_READ
#define MADV_POPULATE_READ 22  // Linux 5.14; older C libraries do not name it
#endif

namespace plvo {
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

// Half a mebibyte at the end of the heap that is never given back to the system: the image libraries take and
// return blocks there for every image, which would otherwise look like growth.
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

// VmHWM of /proc/self/status, in kB there. getrusage would count what this process was before it
// became this program.
std::int64_t peak_resident_bytes() {
  const std::string key = "VmHWM:";
  std::ifstream stream("/proc/self/status");
  for (std::string line; std::getline(stream, line);)
    if (line.rfind(key, 0) == 0) return std::stoll(line.substr(key.size())) * 1024;
  return 0;
}

void forget_peak_resident() { std::ofstream("/proc/self/clear_refs") << "5"; }

void prefault_program() {
  dl_iterate_phdr(populate_segments, nullptr);
  touch_stack();
  touch_heap();
  (void)resident_memory();
}

}  // namespace plvo
