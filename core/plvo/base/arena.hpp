// SPDX-License-Identifier: Apache-2.0
// The only memory of the core: one block that the caller owns. What lives for ever is allocated at init, from
// the front, once; what lives for one stage is taken behind it and given back by rewinding to a mark. A
// component states what it needs by carving: from an arena with memory it gets bytes, from one that only
// counts (at compile time, if need be) the same code adds them up, so the two can never disagree.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <span>
#include <type_traits>

#include "plvo/base/build.hpp"

namespace plvo {

// Every take starts on this boundary: a cache line, and enough for any type of the core.
inline constexpr std::size_t kArenaAlignment = 64;

// Saturates at the largest multiple of the alignment, which no block ever holds.
constexpr std::size_t align_up(std::size_t bytes) {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max() / kArenaAlignment * kArenaAlignment;
  return bytes > kMost ? kMost : (bytes + kArenaAlignment - 1) / kArenaAlignment * kArenaAlignment;
}

// Bytes of an array of `count` elements, rounded up to the alignment; saturates instead of wrapping around.
constexpr std::size_t array_bytes(std::size_t count, std::size_t element_bytes) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  return align_up(count > most / element_bytes ? most : count * element_bytes);
}

class Arena {
 public:
  // Who took what before seal(): the source of docs/memory.md. Names are compared as text; those beyond the
  // last free record share one named "others". Small code keeps no records, and no names.
  struct Record {
    const char* who = nullptr;
    std::size_t bytes = 0;
  };
  static constexpr std::size_t kMaxRecords = kSizeOptimised ? 0 : 64;

  Arena() = default;  // room for nothing
  // memory: the caller's block, aligned to kArenaAlignment (a misaligned start is skipped over).
  explicit Arena(std::span<std::byte> memory);
  // Without memory: every array is empty, and peak() is what an Arena must hold.
  static constexpr Arena counting() {
    Arena arena;
    arena.counts_ = true;
    arena.capacity_ = align_up(std::numeric_limits<std::size_t>::max());
    return arena;
  }

  // An array of count elements, or an empty span (and exhausted() from then on) when the block is full. They
  // are default-initialised: members with an initialiser have its value, all others hold what happened to lie
  // there. T is trivially destructible: nothing is ever destroyed here, only rewound.
  template <typename T>
  constexpr std::span<T> take(const char* who, std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kArenaAlignment);
    const std::size_t bytes = array_bytes(count, sizeof(T));
    if (std::is_constant_evaluated()) {  // without memory
      add(bytes);
      return {};
    }
    return construct<T>(take_bytes(kSizeOptimised ? nullptr : who, bytes), count);
  }

  // Scratch: take after mark(), give back with rewind(). Stages nest like a stack.
  constexpr std::size_t mark() const { return used_; }
  constexpr void rewind(std::size_t mark) { used_ = mark; }

  // Ends the carving of init: later takes are scratch and leave no record.
  void seal() { sealed_ = true; }

  bool exhausted() const { return exhausted_; }
  constexpr std::size_t used() const { return used_; }
  constexpr std::size_t peak() const { return peak_; }
  std::size_t capacity() const { return capacity_; }
  std::span<const Record> records() const { return {records_.data(), record_count_}; }

 private:
  template <typename T>
  static std::span<T> construct(std::byte* bytes, std::size_t count) {
    if (bytes == nullptr) return {};
    T* first = reinterpret_cast<T*>(bytes);
    for (std::size_t i = 0; i < count; ++i) new (first + i) T;
    return {first, count};
  }
  // What only counts stays at its capacity.
  constexpr void add(std::size_t aligned_bytes) {
    used_ += std::min(aligned_bytes, capacity_ - used_);
    if (used_ > peak_) peak_ = used_;
  }
  // aligned_bytes is a multiple of kArenaAlignment.
  std::byte* take_bytes(const char* who, std::size_t aligned_bytes);
  void record(const char* who, std::size_t aligned_bytes);

  std::byte* base_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t used_ = 0;
  std::size_t peak_ = 0;
  bool counts_ = false;
  bool exhausted_ = false;
  bool sealed_ = false;
  std::array<Record, kMaxRecords> records_{};
  std::size_t record_count_ = 0;
};

// Rewinds the memory to where it stood, whichever way a stage is left.
class ScratchScope {
 public:
  constexpr explicit ScratchScope(Arena& memory) : memory_(memory), mark_(memory.mark()) {}
  constexpr ~ScratchScope() { memory_.rewind(mark_); }
  ScratchScope(const ScratchScope&) = delete;
  ScratchScope& operator=(const ScratchScope&) = delete;

 private:
  Arena& memory_;
  std::size_t mark_;
};

}  // namespace plvo
