// SPDX-License-Identifier: Apache-2.0
// LineReader on a named pipe, whose writer comes, stalls, leaves and comes again, and on files.
#include "plvo/host/stream/line_reader.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "temporary_folder.hpp"

namespace plvo {
namespace {

std::vector<std::string> lines_of(LineReader& reader) {
  std::vector<std::string> lines;
  for (std::string line; reader.next(line);) lines.push_back(line);
  return lines;
}

using Lines = std::vector<std::string>;

class NamedPipe : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0); }
  int writer() const { return ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC); }
  static void write(int descriptor, const std::string& text) {
    ASSERT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  test::TemporaryFolder folder_;
  std::string path_ = (folder_ / "pipe").string();
  LineReader reader_;
};

TEST_F(NamedPipe, WholeLinesAloneAreGiven) {
  ASSERT_TRUE(reader_.open(path_).ok()) << "without a writer";
  EXPECT_EQ(lines_of(reader_), Lines());
  EXPECT_FALSE(reader_.ended()) << "it has not begun";
  const int first = writer();
  EXPECT_EQ(lines_of(reader_), Lines());
  write(first, "one\n\ntwo\nthr");
  EXPECT_EQ(lines_of(reader_), (Lines{"one", "", "two"}));
  EXPECT_FALSE(reader_.ended());
  write(first, "ee\nrest");
  EXPECT_EQ(lines_of(reader_), Lines{"three"});
  ::close(first);
  EXPECT_EQ(lines_of(reader_), Lines()) << "a line without an end is none";
  EXPECT_TRUE(reader_.ended());
  const int second = writer();
  write(second, " of it\nfour\n");
  EXPECT_EQ(lines_of(reader_), (Lines{"rest of it", "four"}));
  EXPECT_FALSE(reader_.ended());
  ::close(second);
}

TEST_F(NamedPipe, ALineThatIsTooLongIsCut) {
  ASSERT_TRUE(reader_.open(path_).ok());
  const int descriptor = writer();
  for (int i = 0; i < 5; ++i) {
    write(descriptor, std::string(3000, 'x'));
    const Lines lines = lines_of(reader_);
    EXPECT_EQ(lines.size(), i == 1 ? 1U : 0U);
    for (const std::string& line : lines) EXPECT_EQ(line.size(), LineReader::kLongestLine);
  }
  write(descriptor, "\nafter\n");
  EXPECT_EQ(lines_of(reader_), Lines{"after"});
  ::close(descriptor);
}

TEST(LineReader, ReadsFilesAndRefusesOthers) {
  const test::TemporaryFolder folder;
  test::write_file(folder / "file", "a\r\nb\n");
  LineReader reader;
  ASSERT_TRUE(reader.open((folder / "file").string()).ok());
  EXPECT_EQ(lines_of(reader), (Lines{"a\r", "b"}));
  EXPECT_TRUE(reader.ended());
  LineReader none, a_folder;
  EXPECT_EQ(none.open((folder / "none").string()).code(), StatusCode::kNotFound);
  EXPECT_FALSE(none.is_open());
  EXPECT_EQ(a_folder.open(folder.path().string()).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plvo
