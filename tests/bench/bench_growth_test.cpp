// SPDX-License-Identifier: Apache-2.0
// Tests plvo_bench growth through the command line, with sequences of a few frames.
#include <gtest/gtest.h>

#include <sstream>

#include "command.hpp"
#include "table_cells.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::cells_of;
using test::CommandResult;
using test::read_file;
using test::run_command;
using test::TemporaryFolder;

const std::string kGrowth =
    std::string(PLVO_BENCH_BINARY) + " growth --frames 3 --sequence-frames 3 --repeats 1 --jobs 2";

using Rows = std::vector<std::vector<std::string>>;

// Returns the rows of the table below this title, the header first.
Rows rows_below(const std::string& text, const std::string& title) {
  Rows rows;
  const std::size_t begin = text.find('\n' + title + "\n\n|");
  if (begin == std::string::npos) return rows;
  std::stringstream lines(text.substr(begin + title.size() + 3));
  for (std::string line; std::getline(lines, line) && line.starts_with("| ");) {
    rows.push_back(cells_of(line));
    if (rows.size() == 1) std::getline(lines, line);  // the separator below the header
  }
  return rows;
}

double number(const Rows& rows, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < rows.at(0).size(); ++i)
    if (rows[0][i] == column) return std::stod(rows.at(row).at(i));
  ADD_FAILURE() << "no column " << column;
  return 0;
}

TEST(BenchGrowth, CostOfAFrameGrowsWithItsImage) {
  const TemporaryFolder folder;
  const CommandResult run =
      run_command(kGrowth + " --tables sizes,sequences --out " + (folder / "out").string());
  if (run.err.find("needs valgrind") != std::string::npos) GTEST_SKIP() << run.err;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(folder / "out" / "growth.md"), run.out);

  const Rows sizes = rows_below(run.out, "Image size");
  constexpr std::size_t kTiny = 1, kQvga = 2, kVgaFeatures = 3, kVga = 4, kLargest = 5;
  ASSERT_EQ(sizes.size(), 1 + kLargest) << run.out;
  EXPECT_EQ(sizes[kVga][0], "640×480");
  EXPECT_EQ(number(sizes, kVga, "× default"), 1);
  EXPECT_LT(number(sizes, kQvga, "keypoints"), number(sizes, kVgaFeatures, "keypoints"));
  EXPECT_LT(number(sizes, kTiny, "all"), number(sizes, kVgaFeatures, "all"));
  for (std::size_t row = kQvga; row < kLargest; ++row) {
    for (const char* column : {"image", "lines", "all", "× default"})
      EXPECT_LE(number(sizes, row, column), number(sizes, row + 1, column)) << run.out;
    EXPECT_GT(number(sizes, row, "CPU ×"), 0);
  }
  // The time to read an image is proportional to its number of pixels.
  EXPECT_NEAR(number(sizes, kLargest, "image") / number(sizes, kVga, "image"), 4, 0.3);
  for (std::size_t row = kTiny; row <= kLargest; ++row) {
    double sum = 0;
    for (const char* column : {"image", "points", "lines", "matching", "motion", "rest"})
      sum += number(sizes, row, column);
    EXPECT_NEAR(sum, number(sizes, row, "all"), 0.31) << run.out;
  }

  const Rows sequences = rows_below(run.out, "Frames of a sequence");
  ASSERT_EQ(sequences.size(), 1U + 1) << run.out;
  EXPECT_EQ(number(sequences, 1, "frames"), 2);
  EXPECT_GE(number(sequences, 1, "p99"), number(sequences, 1, "median"));
  EXPECT_GE(number(sequences, 1, "most"), number(sequences, 1, "p99"));
  EXPECT_NEAR(number(sequences, 1, "median"), number(sizes, kVga, "all"), 0.11) << "the same frames";
  EXPECT_NE(run.out.find("\n- rendered sequence, p99 / median: "), std::string::npos) << run.out;
}

TEST(BenchGrowth, RejectsBadInputWithAMessage) {
  const TemporaryFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  const CommandResult table = run_command(kGrowth + " --tables sizes,moons" + out);
  EXPECT_EQ(table.exit_code, 1);
  EXPECT_NE(table.err.find("\"moons\"; choose of: sizes"), std::string::npos) << table.err;
  const CommandResult scene = run_command(kGrowth + " --scene moon" + out);
  EXPECT_EQ(scene.exit_code, 1);
  EXPECT_NE(scene.err.find("corridor"), std::string::npos) << scene.err;
  EXPECT_EQ(run_command(kGrowth + " /no/such/folder" + out).exit_code, 1);
  EXPECT_EQ(run_command(kGrowth).exit_code, 2);
  EXPECT_EQ(run_command(kGrowth + " --frames 1" + out).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace plvo
