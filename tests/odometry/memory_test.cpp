// SPDX-License-Identifier: Apache-2.0
// Memory of the odometry: it lies between a floor and a ceiling, equals required_bytes, and agrees with
// docs/developer/memory.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "memory_table.hpp"

namespace plvo {
namespace {

// At compile time: a caller may use a static array as the block.
static_assert(required_bytes(Limits::vga()) <= kVgaCeiling);
static_assert(required_bytes(Limits::qvga()) <= kQvgaCeiling);
static_assert(required_bytes(Limits::tiny()) <= kTinyCeiling);
// A grey image and its gradients alone need this much. With less, a module would not count its memory.
static_assert(required_bytes(Limits::vga()) > 640 * 480 * 2);
static_assert(required_bytes(Limits::qvga()) > 320 * 240 * 2);
static_assert(required_bytes(Limits::tiny()) > 320 * 240 * 2);

const MemoryUse& vga() {
  static const MemoryUse use = measure_memory(Limits::vga(), Config{}, 3);
  return use;
}
const MemoryUse& qvga() {
  static const MemoryUse use = measure_memory(Limits::qvga(), Config{}, 6);
  return use;
}
const MemoryUse& tiny() {
  static const MemoryUse use = measure_memory(Limits::tiny(), Config::tiny(), 6);
  return use;
}

TEST(Memory, RecordsEveryByteOfInit) {
  for (const MemoryUse* use : {&vga(), &qvga(), &tiny()}) {
    ASSERT_FALSE(use->rows.empty());
    std::size_t sum = 0;
    for (const MemoryUse::Row& row : use->rows) {
      EXPECT_GT(row.bytes, 0U) << row.who;
      sum += row.bytes;
    }
    EXPECT_EQ(sum, use->used);
  }
}

// Bytes for VGA, QVGA, tiny: a little more than each module takes today. The totals have their own ceilings.
struct Ceiling {
  const char* who;
  std::size_t bytes[3];
};
constexpr Ceiling kCeilings[] = {
    {"point features", {459'000, 87'000, 115'000}}, {"line features", {485'000, 92'000, 61'000}},
    {"feature view", {20'000, 5'200, 7'000}},       {"undistortion map", {231'000, 58'000, 58'000}},
    {"smoothing row", {1'400, 800, 800}},           {"pyramid", {410'000, 103'000, 103'000}},
    {"segment detector", {2'200, 2'200, 2'200}},    {"image to align with", {20'000, 5'000, 5'000}},
    {"point tracks", {101'000, 26'000, 26'000}},    {"line tracks", {2'600, 700, 400}},
    {"surface features", {52'000, 0, 0}},           {"surface tracks", {58'000, 0, 0}},
};

TEST(Memory, EveryModuleStaysBelowItsCeiling) {
  const MemoryUse* const uses[] = {&vga(), &qvga(), &tiny()};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto modules = std::count_if(std::begin(kCeilings), std::end(kCeilings),
                                       [&](const Ceiling& c) { return c.bytes[i] > 0; });
    EXPECT_EQ(static_cast<std::ptrdiff_t>(uses[i]->rows.size()), modules) << "a module without a ceiling";
    for (const MemoryUse::Row& row : uses[i]->rows) {
      const auto* ceiling = std::find_if(std::begin(kCeilings), std::end(kCeilings),
                                         [&](const Ceiling& c) { return row.who == c.who; });
      ASSERT_NE(ceiling, std::end(kCeilings)) << row.who << " has no ceiling";
      EXPECT_LE(row.bytes, ceiling->bytes[i]) << row.who;
    }
  }
}

TEST(Memory, ScratchFitsBehindTheMemoryOfInit) {
  for (const MemoryUse* use : {&vga(), &qvga(), &tiny()}) {
    EXPECT_GT(use->peak, use->used) << "frames were tracked, so scratch was taken";
    EXPECT_LE(use->peak, use->required);
  }
}

TEST(Memory, InitNeedsExactlyTheRequiredBytes) {
  constexpr Limits kLimits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(kLimits));
  CameraModel camera{320, 240, {260, 260, 160, 120}, {}};
  Odometry odometry;
  EXPECT_TRUE(odometry.init(memory, camera, Config{}, kLimits).ok());
  const Status status = odometry.init(std::span(memory).first(memory.size() - 1), camera, Config{}, kLimits);
  EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
  EXPECT_NE(std::string(status.message()).find(std::to_string(memory.size())), std::string::npos)
      << "the message names the bytes that are needed: " << status.message();
  EXPECT_EQ(odometry.init({}, camera, Config{}, kLimits).code(), StatusCode::kOutOfMemory);
}

TEST(Memory, AcceptsAMisalignedBlockOfTheRequiredSize) {
  constexpr Limits kLimits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(kLimits) + 1);
  CameraModel camera{320, 240, {260, 260, 160, 120}, {}};
  Odometry odometry;
  EXPECT_TRUE(odometry.init(std::span(memory).subspan(1), camera, Config{}, kLimits).ok());
}

TEST(Memory, ThePageHasTheMeasuredBytes) {
  if (sizeof(void*) != 8) GTEST_SKIP() << "the page is about 64-bit machines";
  std::stringstream committed;
  committed << std::ifstream(PLVO_MEMORY_DOC).rdbuf();
  // The rest of the page is about stacks and code; other tests check it.
  const std::size_t end = committed.str().find(kMemoryPageEnd);
  ASSERT_NE(end, std::string::npos) << "the page has no heading" << kMemoryPageEnd;
  const std::string page = memory_page({vga(), qvga(), tiny()}) + committed.str().substr(end);
  if (std::getenv("PLVO_UPDATE_DOCS") != nullptr) std::ofstream(PLVO_MEMORY_DOC) << page;
  EXPECT_EQ(committed.str(), page) << "write it anew: PLVO_UPDATE_DOCS=1 "
                                   << "ctest --preset release -R '^memory_test$'";
}

}  // namespace
}  // namespace plvo
