// SPDX-License-Identifier: Apache-2.0
// Wrong stamps, and whether the message names the cause.
#include "plvo/replay/index/stamp_order.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/replay/index/tum_index.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;
using test::TemporaryFolder;
using test::write_file;

constexpr std::int64_t kTolerance_ns = 20'000'000;

// A list of `count` images, 1/30 s apart, from `first_s` on; a second has `unit` units.
std::string list(const char* folder, double first_s, double unit = 1, int count = 30) {
  std::string text = "# stamp file\n";
  for (int i = 0; i < count; ++i)
    text += fmt::format("{:.6f} {}/{}.png\n", (first_s + i / 30.0) * unit, folder, i);
  return text;
}

class StampOrder : public ::testing::Test {
 protected:
  Status read(const std::string& rgb, const std::string& depth) {
    write_file(folder_ / "rgb.txt", rgb);
    write_file(folder_ / "depth.txt", depth);
    return read_tum_index(folder_.path(), {}, kTolerance_ns, index_);
  }
  TemporaryFolder folder_;
  SequenceIndex index_;
};

TEST_F(StampOrder, AcceptsGoodLists) {
  ASSERT_TRUE(read(list("rgb", 5), list("depth", 5.012)).ok());
  EXPECT_EQ(index_.remark, "");
  // Depth begins and ends one frame later.
  ASSERT_TRUE(read(list("rgb", 5), list("depth", 5.04)).ok());
  EXPECT_EQ(index_.remark, "");
}

TEST_F(StampOrder, ReportsClockStepWithSizeAndLine) {
  const std::string before = list("rgb", 5),
                    after = list("rgb", 5.5).substr(std::string("# stamp file\n").size());
  const Status status = read(before + after, list("depth", 5));
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(status, "rgb.txt line 32: the clock steps back by 0.500 s, to 5.500000"))
      << status.message();
  EXPECT_TRUE(says(status, "do not sort")) << status.message();
  EXPECT_TRUE(says(status, "or end the lists here")) << "the whole sentence: " << status.message();
  // The step is longer than the recording before it.
  EXPECT_TRUE(
      says(read(list("rgb", 3600) + list("rgb", 1), list("depth", 5)), "the clock steps back by 3600.000 s"));
  // The same in the list of depth and in a list of pairs.
  EXPECT_TRUE(
      says(read(list("rgb", 5), list("depth", 5) + after), "depth.txt line 32: the clock steps back"));
  std::string pairs;
  for (int i = 0; i < 40; ++i)
    pairs += fmt::format("{0:.3f} a{1}.png {0:.3f} b{1}.png\n", i < 20 ? 9 + 0.1 * i : 8 + 0.1 * i, i);
  write_file(folder_ / "pairs.txt", pairs);
  EXPECT_TRUE(says(read_tum_index(folder_.path(), folder_ / "pairs.txt", kTolerance_ns, index_),
                   "pairs.txt line 21: the clock steps back by 1.000 s"));
}

TEST_F(StampOrder, AdvisesToSortUnsortedLists) {
  // In the order of a shell: 1.png, 10.png, 11.png, 2.png …
  for (const int count : {10, 12, 25, 150}) {
    std::vector<std::string> lines;
    for (int i = 1; i <= count; ++i) lines.push_back(fmt::format("{}.5 rgb/{}.png\n", i, i));
    std::sort(lines.begin(), lines.end());
    std::string text;
    for (const std::string& line : lines) text += line;
    EXPECT_TRUE(says(read(text, list("depth", 1)), "runs backwards; sort the list")) << count;
  }
  std::string swapped;
  for (const int i : {1, 2, 3, 5, 4, 6, 7, 8, 9, 10}) swapped += fmt::format("{}.0 rgb/{}.png\n", i, i);
  EXPECT_TRUE(says(read(swapped, list("depth", 1)), "line 5: stamp 4.000000 runs backwards; sort the list"));
}

TEST_F(StampOrder, ReportsStampsThatAreNotSeconds) {
  for (const auto& [unit, name] :
       {std::pair(1e3, "milliseconds"), std::pair(1e6, "microseconds"), std::pair(1e9, "nanoseconds")}) {
    // Counted from 1970, these stamps cannot be read.
    const Status since_1970 = read(list("rgb", 1305031102, unit), list("depth", 1305031102));
    EXPECT_EQ(since_1970.code(), StatusCode::kDamaged);
    EXPECT_TRUE(says(since_1970, "rgb.txt line 2: expected 'stamp file'; stamps are seconds, and 1305031102"))
        << since_1970.message();
    EXPECT_TRUE(says(since_1970, name)) << since_1970.message();
    // Counted from the start of the recording, they can.
    ASSERT_TRUE(read(list("rgb", 0, unit), list("depth", 0, unit)).ok()) << name;
    EXPECT_NE(index_.remark.find(name), std::string::npos) << index_.remark;
    const Status no_pair = read(list("rgb", 0, unit), list("depth", 0.005, unit));
    EXPECT_EQ(no_pair.code(), StatusCode::kInvalidArgument);
    EXPECT_TRUE(says(no_pair, name)) << no_pair.message();
  }
  EXPECT_EQ(stamp_error("1305031102175"),
            "stamps are seconds, and 1305031102175 looks like milliseconds; divide the stamps by 1e3");
  EXPECT_EQ(stamp_error("nan"), "'nan' is not a stamp in seconds");
  EXPECT_EQ(stamp_unit_doubt({0, 1'000'000'000, 3'000'000'000}), "") << "a slow camera";
  EXPECT_EQ(stamp_unit_doubt({INT64_MIN, INT64_MAX}), "") << "nothing that a unit explains";
}

TEST_F(StampOrder, ReportsConstantClockOffset) {
  // No images pair up.
  Status status = read(list("rgb", 5), list("depth", 8.25));
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(says(status, "the clock of depth is 3.250 s ahead: subtract that from the stamps of depth"))
      << status.message();
  status = read(list("rgb", 5), list("depth", 1.75));
  EXPECT_TRUE(says(status, "the clock of depth is 3.250 s behind")) << status.message();
  status = read(list("rgb", 5), list("depth", 50, 1, 90));
  EXPECT_TRUE(
      says(status, "colour's stamps go from 5.000000 to 5.966667, depth's from 50.000000 to 52.966667"))
      << status.message();
  // Where the lists overlap, images of different moments are paired.
  ASSERT_TRUE(read(list("rgb", 5), list("depth", 5.5)).ok());
  EXPECT_NE(index_.remark.find("depth begins and ends 0.500 s later than colour"), std::string::npos)
      << index_.remark;
  EXPECT_NE(index_.remark.find("moved by -0.500 s"), std::string::npos) << index_.remark;
  // A stream that begins later but ends with the other has no clock offset.
  ASSERT_TRUE(read(list("rgb", 5), list("depth", 5.5, 1, 15)).ok());
  EXPECT_EQ(index_.remark, "");
}

TEST(ClockOffset, HandlesExtremeStamps) {
  const std::vector<std::int64_t> far = {INT64_MIN, INT64_MIN + 1, -1, 1, INT64_MAX - 1, INT64_MAX},
                                  near = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(clock_offset_ns(far, near), std::nullopt);
  EXPECT_EQ(clock_offset_ns(near, far), std::nullopt);
  EXPECT_EQ(clock_offset_ns(far, far), std::nullopt);
  EXPECT_EQ(clock_offset_ns({}, near), std::nullopt);
  EXPECT_FALSE(find_stamp_fault(far));
  ASSERT_TRUE(find_stamp_fault({1, INT64_MAX, INT64_MIN}));
}

}  // namespace
}  // namespace plvo
