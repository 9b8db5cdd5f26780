// SPDX-License-Identifier: Apache-2.0
// Tests plvo_bench detectors through the command line, with a few rendered frames.
#include <gtest/gtest.h>

#include <vector>

#include "command.hpp"
#include "table_cells.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::read_file;
using test::run_command;
using test::TemporaryFolder;

const std::string kDetectors = std::string(PLVO_BENCH_BINARY) + " detectors";

// Returns the numbers of the row that begins with this sequence and detector.
std::vector<double> row_of(const std::string& text, const std::string& begin) {
  std::vector<double> numbers;
  const std::size_t at = text.find("\n| " + begin + " | ");
  if (at == std::string::npos) return numbers;
  const std::size_t rest = at + 3 + begin.size();
  for (const std::string& cell : test::cells_of(text.substr(rest, text.find('\n', rest) - rest)))
    if (cell.find_first_of("0123456789") != std::string::npos) numbers.push_back(std::stod(cell));
  return numbers;
}

TEST(BenchDetectors, FindFeaturesRepeatably) {
  const TemporaryFolder folder;
  const CommandResult run =
      run_command(kDetectors + " --scenes corridor --frames 3 --gap 1 --out " + (folder / "out").string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(folder / "out" / "detectors.md"), run.out);
  const std::vector<double> segments = row_of(run.out, "corridor | plvo (LSD at half size)");
  ASSERT_EQ(segments.size(), 9U) << run.out;
  EXPECT_GT(segments[0], 50);
  EXPECT_GT(segments[1], 70) << "again";
  EXPECT_LT(segments[2], segments[1] - 30) << "aside";
  EXPECT_GT(segments[4], 50) << "recall";
  EXPECT_GT(segments[6], 90) << "precision";
  EXPECT_LT(segments[7], segments[6] - 30) << "aside";
  EXPECT_EQ(segments[8], 1) << "CPU ×";
  const std::vector<double> points = row_of(run.out, "corridor | plvo");
  ASSERT_EQ(points.size(), 5U) << run.out;
  EXPECT_GT(points[1], 50);
  EXPECT_LT(points[2], 20);
  if (run.out.find("OpenCV") == std::string::npos || run.out.find("OpenCV absent") != std::string::npos)
    GTEST_SKIP() << "OpenCV's contrib modules are not installed: only ours were measured";
  for (const char* peer :
       {"corridor | OpenCV LSD", "corridor | OpenCV EDLines", "corridor | OpenCV FastLineDetector"}) {
    ASSERT_EQ(row_of(run.out, peer).size(), 9U) << peer << '\n' << run.out;
    EXPECT_GT(row_of(run.out, peer)[4], 30) << peer;
  }
  for (const char* peer : {"corridor | OpenCV ORB", "corridor | OpenCV FAST"}) {
    ASSERT_EQ(row_of(run.out, peer).size(), 5U) << peer << '\n' << run.out;
    EXPECT_LE(row_of(run.out, peer)[0], 400) << peer;
    EXPECT_GT(row_of(run.out, peer)[1], 30) << peer;
  }
}

TEST(BenchDetectors, RejectBadInputWithAMessage) {
  const TemporaryFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  const CommandResult gap = run_command(kDetectors + " --scenes bare --frames 2 --gap 2" + out);
  EXPECT_EQ(gap.exit_code, 1);
  EXPECT_NE(gap.err.find("--gap is 2"), std::string::npos) << gap.err;
  EXPECT_EQ(run_command(kDetectors + " --scenes moon" + out).exit_code, 1);
  EXPECT_EQ(run_command(kDetectors + " /no/such/folder" + out).exit_code, 1);
  EXPECT_EQ(run_command(kDetectors + " --segments 0" + out).exit_code, 2);
  EXPECT_EQ(run_command(kDetectors).exit_code, 2);
}

}  // namespace
}  // namespace plvo
