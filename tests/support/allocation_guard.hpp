// SPDX-License-Identifier: Apache-2.0
// Proof that a stretch of code neither takes nor returns heap memory. The program that links
// allocation_guard.cpp has its own malloc, free and their kin, laid over those of the GNU C library; while a
// guard lives, every call on the guard's thread is counted. It catches operator new, Eigen's temporaries and
// calls from inside libraries alike. A sanitizer has its own malloc: there the counts stay zero, and
// available() says so.
#pragma once

#include <cstdint>

namespace plvo {

class AllocationGuard {
 public:
  AllocationGuard();
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  // Counting can be interrupted, say to report a failure in the middle.
  void disarm();
  void arm();

  std::int64_t taken() const;     // calls of malloc, calloc, realloc, aligned_alloc, posix_memalign, memalign
  std::int64_t returned() const;  // calls of free with a pointer that is not null
  std::int64_t calls() const { return taken() + returned(); }

  // False under a sanitizer or without the GNU C library: the test must skip, and say why.
  static bool available();
};

}  // namespace plvo
