// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/tum_index.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "plvo/base/random.hpp"
#include "plvo/host/stamp_text.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;
using test::write_file;

constexpr std::int64_t kTolerance = 20'000'000;

bool says(const Status& status, std::string_view words) {
  return std::string_view(status.message()).find(words) != std::string_view::npos;
}

TEST(StampText, RoundTripsEveryNanosecond) {
  std::int64_t stamp = 0;
  ASSERT_TRUE(parse_stamp_ns("1305031102.175304", stamp));
  EXPECT_EQ(stamp, 1305031102175304000);
  EXPECT_EQ(format_stamp(stamp), "1305031102.175304");
  EXPECT_EQ(format_stamp(stamp + 1), "1305031102.175304001");
  ASSERT_TRUE(parse_stamp_ns("-0.5", stamp));
  EXPECT_EQ(stamp, -500'000'000);
  EXPECT_EQ(format_stamp(stamp), "-0.500000");
  ASSERT_TRUE(parse_stamp_ns("1.036224e-01", stamp));
  EXPECT_EQ(stamp, 103'622'400);
  ASSERT_TRUE(parse_stamp_ns("7", stamp));
  EXPECT_EQ(stamp, 7'000'000'000);
  for (const char* wrong : {"", ".", "-", "nan", "inf", "1.2.3", "12a", "1e400", "99999999999999999999"})
    EXPECT_FALSE(parse_stamp_ns(wrong, stamp)) << wrong;
}

TEST(Associate, TakesTheBestPairsFirstAndEachImageOnce) {
  // 10 and 12 both lie near 11: the nearer one (12 → 11.9) wins, 10 takes what is left.
  const auto pairs = associate({10, 12, 30}, {9, 11, 50}, 3);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0], (std::pair<std::size_t, std::size_t>(0, 0)));
  EXPECT_EQ(pairs[1], (std::pair<std::size_t, std::size_t>(1, 1)));
  EXPECT_TRUE(associate({10}, {14}, 3).empty());
  EXPECT_EQ(associate({10}, {13}, 3).size(), 1u);  // the tolerance itself still pairs
}

// The slow obvious version: repeatedly take the closest pair of all that are left.
TEST(Associate, EqualsExhaustiveSearch) {
  Random random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::int64_t> a, b;
    for (std::int64_t t = 0; t < 60;) a.push_back(t += 1 + static_cast<std::int64_t>(random.below(6)));
    for (std::int64_t t = 0; t < 60;) b.push_back(t += 1 + static_cast<std::int64_t>(random.below(6)));
    std::vector<std::pair<std::size_t, std::size_t>> expected;
    std::vector<bool> used_a(a.size()), used_b(b.size());
    while (true) {
      std::int64_t best = std::numeric_limits<std::int64_t>::max();
      std::pair<std::size_t, std::size_t> choice;
      for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
          if (const std::int64_t d = std::abs(a[i] - b[j]); !used_a[i] && !used_b[j] && d <= 4 && d < best) {
            best = d;
            choice = {i, j};
          }
      if (best == std::numeric_limits<std::int64_t>::max()) break;
      used_a[choice.first] = used_b[choice.second] = true;
      expected.push_back(choice);
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(associate(a, b, 4), expected);
  }
}

TEST(TumIndex, PairsTwoLists) {
  const TemporaryFolder folder;
  write_file(folder / "rgb.txt", "# header\n1.000000 rgb/a.png\n\n1.033000 rgb/b.png\r\n1.066 rgb/c.png\n");
  write_file(folder / "depth.txt", "1.001000 depth/a.png\n1.060000 depth/c.png\n9.0 depth/z.png\n");
  TumIndex index;
  const Status status = read_tum_index(folder.path(), {}, kTolerance, index);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(index.pairs.size(), 2u);
  EXPECT_EQ(index.pairs[0].colour.file, "rgb/a.png");
  EXPECT_EQ(index.pairs[1].depth.file, "depth/c.png");
  EXPECT_EQ(index.pairs[1].depth.stamp_ns, 1'060'000'000);
  EXPECT_EQ(index.unpaired_colour, 1u);
  EXPECT_EQ(index.unpaired_depth, 1u);
}

TEST(TumIndex, ReadsAssociations) {
  const TemporaryFolder folder;
  write_file(folder / "associations.txt", "1.0 rgb/a.png 1.1 depth/a.png\n2.0 rgb/b.png 2.1 depth/b.png\n");
  TumIndex index;
  ASSERT_TRUE(read_tum_index(folder.path(), {}, kTolerance, index).ok());
  ASSERT_EQ(index.pairs.size(), 2u);
  EXPECT_EQ(index.pairs[1].depth.stamp_ns, 2'100'000'000);
  write_file(folder / "mine.txt", "1.0 rgb/a.png 1.1\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), folder / "mine.txt", kTolerance, index),
                   "mine.txt line 1: expected 'stamp rgb stamp depth'"));
}

TEST(TumIndex, BadFolders) {
  const TemporaryFolder folder;
  TumIndex index;
  EXPECT_TRUE(says(read_tum_index(folder / "none", {}, kTolerance, index), "is not a folder"));
  EXPECT_TRUE(
      says(read_tum_index(folder.path(), {}, kTolerance, index), "rgb.txt; a sequence needs rgb.txt"));
  write_file(folder / "rgb.txt", "1.0 rgb/a.png\n");
  const Status no_depth = read_tum_index(folder.path(), {}, kTolerance, index);
  EXPECT_EQ(no_depth.code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(no_depth, "depth.txt"));
  write_file(folder / "depth.txt", "5.0 depth/a.png\n");
  EXPECT_TRUE(
      says(read_tum_index(folder.path(), {}, kTolerance, index), "no colour image has a depth image within"));
  write_file(folder / "depth.txt", "# nothing\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), {}, kTolerance, index), "lists no image"));
}

TEST(TumIndex, BadStamps) {
  const TemporaryFolder folder;
  TumIndex index;
  write_file(folder / "depth.txt", "1.0 depth/a.png\n");
  write_file(folder / "rgb.txt", "1.0 rgb/a.png\n0.5 rgb/b.png\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), {}, kTolerance, index),
                   "rgb.txt line 2: stamp 0.500000 runs backwards; sort the list"));
  write_file(folder / "rgb.txt", "1.0 rgb/a.png\n1.0 rgb/b.png\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), {}, kTolerance, index), "stamp 1.000000 appears twice"));
  write_file(folder / "rgb.txt", "nan rgb/a.png\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), {}, kTolerance, index), "line 1: expected 'stamp file'"));
}

}  // namespace
}  // namespace plvo
