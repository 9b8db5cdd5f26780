// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/arena.hpp"

#include <string_view>

namespace plvo {

Arena::Arena(std::span<std::byte> memory) {
  const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(memory.data()) % kArenaAlignment;
  const std::size_t skip = misaligned == 0 ? 0 : kArenaAlignment - misaligned;
  if (memory.data() == nullptr || memory.size() < skip) return;
  base_ = memory.data() + skip;
  capacity_ = memory.size() - skip;
}

std::byte* Arena::take_bytes(const char* who, std::size_t aligned_bytes) {
  if (counts_) {
    add(aligned_bytes);
    return nullptr;
  }
  if (base_ == nullptr || aligned_bytes > capacity_ - used_) {
    exhausted_ = true;
    return nullptr;
  }
  std::byte* start = base_ + used_;
  add(aligned_bytes);
  if constexpr (kMaxRecords > 0)
    if (!sealed_) record(who, aligned_bytes);
  return start;
}

void Arena::record(const char* who, std::size_t aligned_bytes) {
  // One record per name: a module that takes several arrays is one row of the table.
  std::size_t i = 0;
  while (i < record_count_ && std::string_view(records_[i].who) != who) ++i;
  if (i == kMaxRecords) {
    i = kMaxRecords - 1;
    records_[i].who = "others";
  } else if (i == record_count_) {
    records_[record_count_++].who = who;
  }
  records_[i].bytes += aligned_bytes;
}

}  // namespace plvo
