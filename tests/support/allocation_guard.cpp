// SPDX-License-Identifier: Apache-2.0
#include "allocation_guard.hpp"

#include <cerrno>
#include <cstddef>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#define PLVO_GUARD_MALLOC 1
#endif
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || __has_feature(thread_sanitizer)
#undef PLVO_GUARD_MALLOC
#endif
#endif

namespace {

// Per thread, so that a helper thread of the test framework is not taken for the code under test.
thread_local bool armed = false;
thread_local std::int64_t takes = 0;
thread_local std::int64_t returns = 0;

}  // namespace

#ifdef PLVO_GUARD_MALLOC
extern "C" {

void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);

void* malloc(std::size_t bytes) {
  if (armed) ++takes;
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) {
  if (armed) ++takes;
  return __libc_calloc(count, bytes);
}

void* realloc(void* block, std::size_t bytes) {
  if (armed) ++takes;
  return __libc_realloc(block, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) {
  if (armed) ++takes;
  return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  if (armed) ++takes;
  return __libc_memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  if (armed) ++takes;
  *block = __libc_memalign(alignment, bytes);
  return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) {
  if (armed && block != nullptr) ++returns;
  __libc_free(block);
}

}  // extern "C"
#endif

namespace plvo {

AllocationGuard::AllocationGuard() {
  takes = 0;
  returns = 0;
  arm();
}
AllocationGuard::~AllocationGuard() { disarm(); }
void AllocationGuard::arm() { armed = true; }
void AllocationGuard::disarm() { armed = false; }
std::int64_t AllocationGuard::taken() const { return takes; }
std::int64_t AllocationGuard::returned() const { return returns; }

bool AllocationGuard::available() {
#ifdef PLVO_GUARD_MALLOC
  return true;
#else
  return false;
#endif
}

}  // namespace plvo
