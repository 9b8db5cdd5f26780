// SPDX-License-Identifier: Apache-2.0
#include "plvo/base/arena.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace plvo {
namespace {

struct Small {
  std::int32_t value = 7;
  std::uint8_t tag = 1;
};

// What a module does at init. The same code runs on a counting arena and on one with memory.
constexpr void allocate(Arena& memory, std::size_t n) {
  (void)memory.take<std::uint8_t>("pixels", 3 * n + 1);
  (void)memory.take<double>("table", n);
  {
    ScratchScope scope(memory);
    (void)memory.take<std::int16_t>("scratch", 10 * n);
    ScratchScope inner(memory);
    (void)memory.take<Small>("scratch", n);
  }
  (void)memory.take<Small>("records", n);
}

constexpr std::size_t allocate_bytes(std::size_t n) {
  Arena sizer = Arena::counting();
  allocate(sizer, n);
  return sizer.peak();
}

class ArenaOf {
 public:
  explicit ArenaOf(std::size_t bytes, std::size_t offset = 0) : storage_(bytes + offset + kArenaAlignment) {
    const auto address = reinterpret_cast<std::uintptr_t>(storage_.data());
    const std::size_t to_boundary = (kArenaAlignment - address % kArenaAlignment) % kArenaAlignment;
    block_ = std::span(storage_).subspan(to_boundary + offset, bytes);
    arena = Arena(block_);
  }
  Arena arena;
  std::span<std::byte> block() const { return block_; }

 private:
  std::vector<std::byte> storage_;
  std::span<std::byte> block_;
};

bool aligned(const void* p) { return reinterpret_cast<std::uintptr_t>(p) % kArenaAlignment == 0; }

TEST(CountingArena, CountsTheSameAtCompileTimeAndAtRunTime) {
  static_assert(allocate_bytes(0) > 0);
  static_assert(allocate_bytes(100) > allocate_bytes(10));
  Arena sizer = Arena::counting();
  allocate(sizer, 100);
  EXPECT_EQ(sizer.peak(), allocate_bytes(100));
  EXPECT_LT(sizer.used(), sizer.peak());
}

TEST(CountingArena, CountsExactlyTheBytesThatTheArenaNeeds) {
  for (std::size_t n : {0U, 1U, 2U, 63U, 64U, 65U, 1000U}) {
    Arena sizer = Arena::counting();
    allocate(sizer, n);
    ArenaOf exact(sizer.peak());
    allocate(exact.arena, n);
    EXPECT_FALSE(exact.arena.exhausted()) << n;
    EXPECT_EQ(exact.arena.peak(), sizer.peak()) << n;
    EXPECT_EQ(exact.arena.used(), sizer.used()) << n;
    ArenaOf short_by_one(sizer.peak() - 1);
    allocate(short_by_one.arena, n);
    EXPECT_TRUE(short_by_one.arena.exhausted()) << n;
  }
}

TEST(Arena, ArraysAreAlignedDisjointAndInsideTheBlock) {
  ArenaOf owner(4096);
  const auto a = owner.arena.take<std::uint8_t>("a", 65);
  const auto b = owner.arena.take<double>("b", 3);
  const auto c = owner.arena.take<Small>("c", 5);
  ASSERT_EQ(a.size(), 65U);
  ASSERT_EQ(b.size(), 3U);
  ASSERT_EQ(c.size(), 5U);
  EXPECT_TRUE(aligned(a.data()) && aligned(b.data()) && aligned(c.data()));
  std::memset(a.data(), 0xff, a.size());
  for (double& x : b) x = -1;
  for (const Small& s : c) EXPECT_EQ(s.value, 7) << "default member initialisers run";
  EXPECT_GE(static_cast<void*>(a.data()), static_cast<void*>(owner.block().data()));
  EXPECT_LE(static_cast<void*>(c.data() + c.size()), static_cast<void*>(owner.block().data() + 4096));
}

TEST(Arena, SkipsToTheFirstAlignedByteOfAMisalignedBlock) {
  for (std::size_t offset : {1U, 8U, 63U}) {
    ArenaOf owner(1024, offset);
    EXPECT_EQ(owner.arena.capacity(), 1024 - (kArenaAlignment - offset));
    const auto bytes = owner.arena.take<std::uint8_t>("a", 1024 - kArenaAlignment);
    ASSERT_FALSE(bytes.empty());
    EXPECT_TRUE(aligned(bytes.data()));
  }
}

TEST(Arena, TakesNothingFromAnEmptyBlock) {
  Arena none;
  EXPECT_TRUE(none.take<std::uint8_t>("a", 1).empty());
  EXPECT_TRUE(none.exhausted());
  ArenaOf tiny(5, 1);  // ends before the first boundary
  EXPECT_EQ(tiny.arena.capacity(), 0U);
  EXPECT_TRUE(tiny.arena.take<std::uint8_t>("a", 1).empty());
}

TEST(Arena, RejectsWhatDoesNotFitAndStaysExhausted) {
  ArenaOf owner(256);
  EXPECT_FALSE(owner.arena.take<std::uint8_t>("a", 192).empty());
  EXPECT_FALSE(owner.arena.exhausted());
  EXPECT_TRUE(owner.arena.take<std::uint8_t>("b", 65).empty());
  EXPECT_TRUE(owner.arena.exhausted());
  EXPECT_EQ(owner.arena.used(), 192U) << "a refused take takes nothing";
  EXPECT_FALSE(owner.arena.take<std::uint8_t>("c", 64).empty());
  EXPECT_TRUE(owner.arena.exhausted());
}

TEST(Arena, RejectsACountWhoseBytesOverflow) {
  ArenaOf owner(256);
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(owner.arena.take<double>("a", most / 8 + 2).empty());  // × 8 wraps to 8
  EXPECT_TRUE(owner.arena.take<std::uint8_t>("b", most).empty());    // rounding up wraps to 0
  EXPECT_TRUE(owner.arena.exhausted());
  EXPECT_EQ(owner.arena.used(), 0U);
}

TEST(CountingArena, SaturatesForACountWhoseBytesOverflow) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  Arena sizer = Arena::counting();
  (void)sizer.take<double>("a", most / 8 + 2);
  EXPECT_EQ(sizer.peak(), most / kArenaAlignment * kArenaAlignment);
  (void)sizer.take<double>("a", 100);
  EXPECT_EQ(sizer.peak(), most / kArenaAlignment * kArenaAlignment);
}

TEST(Arena, ReleasesScratchOnEveryReturnPath) {
  ArenaOf owner(1024);
  (void)owner.arena.take<std::uint8_t>("kept", 64);
  const auto stage = [&](bool early) {
    ScratchScope scope(owner.arena);
    (void)owner.arena.take<std::uint8_t>("scratch", 512);
    if (early) return;
    (void)owner.arena.take<std::uint8_t>("scratch", 128);
  };
  for (int frame = 0; frame < 100; ++frame) stage(frame % 2 == 0);
  EXPECT_EQ(owner.arena.used(), 64U);
  EXPECT_EQ(owner.arena.peak(), 64U + 512U + 128U);
  EXPECT_FALSE(owner.arena.exhausted());
}

TEST(Arena, KnowsTheMemoryThatWasTakenSinceAMark) {
  alignas(kArenaAlignment) std::array<std::byte, 4096> block{};
  Arena arena(block);
  (void)arena.take<int>("before", 3);
  const std::size_t mark = arena.mark();
  EXPECT_TRUE(arena.since(mark).empty());
  const std::span<double> first = arena.take<double>("first", 5);
  const std::span<char> last = arena.take<char>("last", 7);
  const std::span<std::byte> taken = arena.since(mark);
  EXPECT_EQ(taken.data(), reinterpret_cast<std::byte*>(first.data()));
  EXPECT_GE(taken.data() + taken.size(), reinterpret_cast<std::byte*>(last.data() + last.size()));
  EXPECT_EQ(taken.size(), arena.used() - mark);
  Arena counting = Arena::counting();
  (void)counting.take<int>("counted", 3);
  EXPECT_TRUE(counting.since(0).empty());
}

TEST(Arena, RecordsBytesPerNameUntilSealed) {
  ArenaOf owner(4096);
  char name_elsewhere[] = "points";  // the same name at another address
  (void)owner.arena.take<std::uint8_t>("points", 10);
  (void)owner.arena.take<double>("image", 8);
  (void)owner.arena.take<std::uint8_t>(name_elsewhere, 65);
  owner.arena.seal();
  (void)owner.arena.take<std::uint8_t>("scratch", 100);
  const auto records = owner.arena.records();
  ASSERT_EQ(records.size(), 2U);
  EXPECT_STREQ(records[0].who, "points");
  EXPECT_EQ(records[0].bytes, 64U + 128U);
  EXPECT_STREQ(records[1].who, "image");
  EXPECT_EQ(records[1].bytes, 64U);
}

TEST(Arena, CountsBytesOfExcessNamesAsOthers) {
  static std::vector<std::string> names;
  for (std::size_t i = 0; i < Arena::kMaxRecords + 10; ++i) names.push_back("module" + std::to_string(i));
  ArenaOf owner(64 * names.size());
  for (const std::string& name : names) (void)owner.arena.take<std::uint8_t>(name.c_str(), 1);
  std::size_t sum = 0;
  for (const Arena::Record& record : owner.arena.records()) sum += record.bytes;
  EXPECT_EQ(sum, owner.arena.used());
  EXPECT_STREQ(owner.arena.records().back().who, "others");
}

}  // namespace
}  // namespace plvo
