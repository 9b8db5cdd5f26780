// SPDX-License-Identifier: Apache-2.0
// The only memory of the core: one block that the caller owns. Permanent arrays are allocated once, at init,
// from the front of the block. Scratch of one stage lies behind them and is released by rewinding to a mark.
// A component states its needs in allocate(). An arena with memory returns bytes; a counting arena adds up
// the sizes with the same code, at compile time if needed. The two therefore always agree.
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

// Every array starts on this boundary. It is one cache line, and it suffices for any type of the core.
inline constexpr std::size_t kArenaAlignment = 64;

// Saturates at the largest multiple of the alignment, which exceeds the size of any block.
constexpr std::size_t align_up(std::size_t bytes) {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max() / kArenaAlignment * kArenaAlignment;
  return bytes > kMost ? kMost : (bytes + kArenaAlignment - 1) / kArenaAlignment * kArenaAlignment;
}

// Bytes of an array of `count` elements, rounded up to the alignment. Saturates instead of wrapping around.
constexpr std::size_t array_bytes(std::size_t count, std::size_t element_bytes) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  return align_up(count > most / element_bytes ? most : count * element_bytes);
}

class Arena {
 public:
  // Bytes that each component took before seal(): the source of docs/developer/memory.md. Names are compared
  // as text. When the records are full, further names share one record named "others". Size-optimised code
  // keeps no records and no names.
  struct Record {
    const char* who = nullptr;
    std::size_t bytes = 0;
  };
  static constexpr std::size_t kMaxRecords = kSizeOptimised ? 0 : 64;

  Arena() = default;  // capacity 0
  // memory: the caller's block. A start that is not aligned to kArenaAlignment is skipped over.
  explicit Arena(std::span<std::byte> memory);
  // An arena without memory: every array is empty, and peak() is the number of bytes that a real arena needs.
  static constexpr Arena counting() {
    Arena arena;
    arena.counts_ = true;
    arena.capacity_ = align_up(std::numeric_limits<std::size_t>::max());
    return arena;
  }

  // Returns an array of count elements. When the block is full, returns an empty span, and exhausted() is
  // true from then on. The elements are default-initialised: members without an initialiser hold whatever the
  // memory held. T is trivially destructible, since the arena never calls a destructor.
  template <typename T>
  constexpr std::span<T> take(const char* who, std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kArenaAlignment);
    const std::size_t bytes = array_bytes(count, sizeof(T));
    if (std::is_constant_evaluated()) {  // counts only
      add(bytes);
      return {};
    }
    return construct<T>(take_bytes(kSizeOptimised ? nullptr : who, bytes), count);
  }

  // Scratch memory: mark(), then take(), then rewind() to the mark. Stages nest like a stack.
  constexpr std::size_t mark() const { return used_; }
  constexpr void rewind(std::size_t mark) { used_ = mark; }
  // The memory that was taken since the mark; empty if the arena only counts.
  constexpr std::span<std::byte> since(std::size_t mark) {
    return counts_ ? std::span<std::byte>() : std::span(base_ + mark, used_ - mark);
  }

  // Ends the allocation of init: later takes are scratch and leave no record.
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
    // Compilers keep the empty loop of a type that has nothing to initialise.
    if constexpr (!std::is_trivially_default_constructible_v<T>)
      for (std::size_t i = 0; i < count; ++i) new (first + i) T;
    return {first, count};
  }
  // A counting arena saturates at its capacity.
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

// Rewinds the arena at the end of the scope, on every path out of a stage.
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
