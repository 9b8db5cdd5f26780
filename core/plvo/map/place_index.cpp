// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/place_index.hpp"

#include <algorithm>

#include "plvo/base/random.hpp"
#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

using KeyBits = std::array<std::array<std::uint8_t, PlaceIndex::kKeyBits>, PlaceIndex::kTables>;

// The bits of every table are different: they are the first ones in a random order of all 256.
constexpr KeyBits draw_key_bits() {
  std::array<std::uint8_t, 256> order{};
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint8_t>(i);
  Random random(2012);
  for (std::size_t i = order.size() - 1; i > 0; --i) {
    const std::size_t j = random.below(static_cast<std::uint32_t>(i + 1));
    const std::uint8_t swapped = order[i];
    order[i] = order[j];
    order[j] = swapped;
  }
  KeyBits bits{};
  std::size_t k = 0;
  for (auto& table : bits)
    for (std::uint8_t& bit : table) bit = order[k++];
  return bits;
}

constexpr KeyBits kSampledBits = draw_key_bits();

std::uint32_t place_key(std::size_t table, const Descriptor& descriptor) {
  std::uint32_t key = 0;
  for (const std::uint8_t bit : kSampledBits[table])
    key = key << 1 | static_cast<std::uint32_t>(descriptor[bit / 64] >> (bit % 64) & 1);
  return key;
}

}  // namespace

void PlaceIndex::clear() {
  std::fill(heads_.begin(), heads_.end(), kEnd);
  std::fill(nexts_.begin(), nexts_.end(), kEnd);
}

// Where there are fewer lists than keys, a multiplication spreads the keys (Knuth's golden ratio).
std::uint32_t& PlaceIndex::head(std::size_t table, const Descriptor& descriptor) {
  const std::uint32_t spread = place_key(table, descriptor) * 2654435769U >> (32 - kKeyBits);
  return heads_[table * lists_ + (spread & (lists_ - 1))];
}

// A new entry comes first; a full list drops its last one.
void PlaceIndex::insert(std::size_t table, std::span<const Descriptor> stored, std::size_t entry) {
  std::uint32_t& first = head(table, stored[entry]);
  next(table, entry) = first;
  first = static_cast<std::uint32_t>(entry);
  std::uint32_t at = first;
  for (std::size_t n = 1; n < kListLength && at != kEnd; ++n) at = next(table, at);
  if (at != kEnd) next(table, at) = kEnd;
}

void PlaceIndex::add(std::span<const Descriptor> stored, std::size_t slot, std::size_t count) {
  for (std::size_t table = 0; table < kTables; ++table)
    for (std::size_t i = 0; i < count; ++i) insert(table, stored, slot * keypoints_ + i);
}

std::uint8_t PlaceIndex::tables_of(std::span<const Descriptor> stored, std::size_t entry) {
  std::uint8_t tables = 0;
  for (std::size_t table = 0; table < kTables; ++table) {
    std::uint32_t at = head(table, stored[entry]);
    while (at != kEnd && at != entry) at = next(table, at);
    if (at == entry) tables = static_cast<std::uint8_t>(tables | 1U << table);
  }
  return tables;
}

void PlaceIndex::add_to_tables(std::span<const Descriptor> stored, std::size_t entry, std::uint8_t tables) {
  for (std::size_t table = 0; table < kTables; ++table)
    if ((tables >> table & 1) != 0) insert(table, stored, entry);
}

void PlaceIndex::remove(std::span<const Descriptor> stored, std::size_t slot, std::size_t count) {
  for (std::size_t table = 0; table < kTables; ++table) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t entry = slot * keypoints_ + i;
      std::uint32_t* link = &head(table, stored[entry]);
      while (*link != kEnd && *link != entry) link = &next(table, *link);
      if (*link == entry) *link = next(table, entry);
    }
  }
}

void PlaceIndex::query(std::span<const Descriptor> stored, std::span<const Descriptor> query,
                       std::span<const std::uint8_t> excluded, FixedVector<PlaceCandidate>& best) {
  std::fill(scores_.begin(), scores_.end(), 0U);
  std::fill(votes_.begin(), votes_.end(), std::uint16_t{0});
  std::fill(voters_.begin(), voters_.end(), 0U);
  std::array<std::uint16_t, kTables * kListLength> voted;
  for (std::size_t i = 0; i < query.size(); ++i) {
    const auto voter = static_cast<std::uint32_t>(i + 1);
    std::size_t count = 0;
    for (std::size_t table = 0; table < kTables; ++table) {
      for (std::uint32_t entry = head(table, query[i]); entry != kEnd; entry = next(table, entry)) {
        const std::size_t slot = entry / keypoints_;
        if (excluded[slot] != 0 || voters_[slot] == voter) continue;
        if (hamming_distance(stored[entry], query[i]) > kNear) continue;
        voters_[slot] = voter;
        ++votes_[slot];
        voted[count++] = static_cast<std::uint16_t>(slot);
      }
    }
    for (std::size_t k = 0; k < count; ++k)
      scores_[voted[k]] += kWholeVote / static_cast<std::uint32_t>(count);
  }
  best.clear();
  while (!best.full()) {
    const auto top = std::max_element(scores_.begin(), scores_.end());  // the first among equal ones
    if (top == scores_.end() || *top == 0) return;
    const auto slot = static_cast<std::uint16_t>(top - scores_.begin());
    best.push_back({slot, *top, votes_[slot]});
    *top = 0;
  }
}

}  // namespace plvo
