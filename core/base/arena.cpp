// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/arena.hpp"

namespace plvo {

Arena::Arena(std::span<std::byte> memory) {
  const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(memory.data()) % kArenaAlignment;
  const std::size_t skip = misaligned == 0 ? 0 : kArenaAlignment - misaligned;
  if (memory.data() == nullptr || memory.size() < skip) return;
  base_ = memory.data() + skip;
  capacity_ = memory.size() - skip;
}

std::byte* Arena::take_bytes(const char* who, std::size_t bytes) {
  const std::size_t needed = align_up(bytes);
  if (needed > capacity_ - used_) {
    exhausted_ = true;
    return nullptr;
  }
  std::byte* start = base_ + used_;
  used_ += needed;
  if (used_ > peak_) peak_ = used_;
  if (!sealed_) {
    // One record a name: a room that takes several arrays is one line of the table.
    std::size_t i = 0;
    while (i < record_count_ && records_[i].who != who) ++i;
    if (i == record_count_ && record_count_ < kMaxRecords) records_[record_count_++].who = who;
    if (i < kMaxRecords) records_[i].bytes += needed;
  }
  return start;
}

}  // namespace plvo
