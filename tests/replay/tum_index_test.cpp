// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/tum_index.hpp"

#include <gtest/gtest.h>

#include "plvo/host/files/stamp_text.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;
using test::TemporaryFolder;
using test::write_file;

constexpr std::int64_t kTolerance = 20'000'000;

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

TEST(TumIndex, PairsTwoLists) {
  const TemporaryFolder folder;
  write_file(folder / "rgb.txt", "# header\n1.000000 rgb/a.png\n\n1.033000 rgb/b.png\r\n1.066 rgb/c.png\n");
  write_file(folder / "depth.txt", "1.001000 depth/a.png\n1.060000 depth/c.png\n9.0 depth/z.png\n");
  SequenceIndex index;
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
  SequenceIndex index;
  ASSERT_TRUE(read_tum_index(folder.path(), {}, kTolerance, index).ok());
  ASSERT_EQ(index.pairs.size(), 2u);
  EXPECT_EQ(index.pairs[1].depth.stamp_ns, 2'100'000'000);
  write_file(folder / "mine.txt", "1.0 rgb/a.png 1.1\n");
  EXPECT_TRUE(says(read_tum_index(folder.path(), folder / "mine.txt", kTolerance, index),
                   "mine.txt line 1: expected 'stamp rgb stamp depth'"));
}

SequenceIndex read_associations(const std::string& lines, Status& status) {
  const TemporaryFolder folder;
  write_file(folder / "associations.txt", lines);
  SequenceIndex index;
  status = read_tum_index(folder.path(), {}, kTolerance, index);
  return index;
}

// The benchmark's script lists first the file that it got first.
TEST(TumIndex, AssociationsMayNameDepthFirst) {
  Status status;
  const SequenceIndex index =
      read_associations("1.0 depth/a.png 1.1 rgb/a.png\n2.0 ./depth/b.png 2.1 ./rgb/b.png\n", status);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(index.pairs.size(), 2u);
  EXPECT_EQ(index.pairs[0].colour.file, "rgb/a.png");
  EXPECT_EQ(index.pairs[0].colour.stamp_ns, 1'100'000'000);
  EXPECT_EQ(index.pairs[1].depth.file, "./depth/b.png");
  // A single line with another order makes the names inconclusive.
  const SequenceIndex mixed =
      read_associations("1.0 depth/a.png 1.1 rgb/a.png\n2.0 rgb/b 2.1 depth/b\n", status);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(mixed.pairs[0].colour.file, "depth/a.png");
}

TEST(TumIndex, NamesMayHoldSpaces) {
  Status status;
  const SequenceIndex index =
      read_associations("1.0 my rgb/a 1.png 1.1  my depth/a  1.PNG\n2.0 rgb/b 2.1 depth/b\r\n", status);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(index.pairs[0].colour.file, "my rgb/a 1.png");
  EXPECT_EQ(index.pairs[0].depth.file, "my depth/a  1.PNG");
  EXPECT_EQ(index.pairs[1].depth.file, "depth/b");

  const TemporaryFolder folder;
  write_file(folder / "rgb.txt", "1.0 rgb/the first.jpeg\n2.0\trgb/second.jpg extra\n");
  write_file(folder / "depth.txt", "1.0 depth/the first.png\n2.0 depth/2\n");
  SequenceIndex lists;
  ASSERT_TRUE(read_tum_index(folder.path(), {}, kTolerance, lists).ok());
  EXPECT_EQ(lists.pairs[0].colour.file, "rgb/the first.jpeg");
  EXPECT_EQ(lists.pairs[0].depth.file, "depth/the first.png");
  EXPECT_EQ(lists.pairs[1].colour.file, "rgb/second.jpg");
}

TEST(TumIndex, IgnoresAByteOrderMark) {
  Status status;
  EXPECT_EQ(read_associations("\xEF\xBB\xBF"
                              "1.0 a.png 1.0 b.png\n",
                              status)
                .pairs.size(),
            1u);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(read_associations("\xEF\xBB\xBF# comment\n1.0 a.png 1.0 b.png\n", status).pairs.size(), 1u);
  (void)read_associations(std::string("\xFF\xFE"
                                      "1\0",
                                      4),
                          status);
  EXPECT_TRUE(says(status, "UTF-16; save it again as UTF-8")) << status.message();
}

TEST(TumIndex, ExplainsHowToPlayAnOniFile) {
  const TemporaryFolder folder;
  write_file(folder / "recording.oni", "NI10");
  SequenceIndex index;
  const Status status = read_sequence_index(folder / "recording.oni", {}, index);
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_TRUE(says(status, "plvo live --device ")) << status.message();
}

TEST(TumIndex, RejectsInvalidFolders) {
  const TemporaryFolder folder;
  SequenceIndex index;
  EXPECT_TRUE(says(read_sequence_index(folder / "none", {}, index), "is not a folder"));
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

TEST(TumIndex, RejectsInvalidStamps) {
  const TemporaryFolder folder;
  SequenceIndex index;
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
