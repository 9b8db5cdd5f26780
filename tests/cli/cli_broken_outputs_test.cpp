// SPDX-License-Identifier: Apache-2.0
// Tests outputs that fail before the program ends: a limit on the file size, a full disk, a closed pipe.
// Every command ends with exit code 1 and a message, its rows are complete, and its other outputs are
// written.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

#include "plvo_command.hpp"
#include "simulated_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::kPlvo;
using test::read_file;
using test::run_command;

constexpr int kTrackedFrames = 24;

const std::string& recording() {
  static const std::string folder = test::simulated_sequence<kTrackedFrames>().string();
  return folder;
}

// A pipe whose reading end is closed.
class BrokenPipe {
 public:
  BrokenPipe() {
    EXPECT_EQ(::pipe(ends_.data()), 0);
    ::close(ends_[0]);
    EXPECT_LE(ends_[1], 9) << "a shell takes one digit";
  }
  BrokenPipe(const BrokenPipe&) = delete;
  BrokenPipe& operator=(const BrokenPipe&) = delete;
  ~BrokenPipe() { ::close(ends_[1]); }
  std::string as_output() const { return " >&" + std::to_string(ends_[1]); }

 private:
  std::array<int, 2> ends_{};
};

class CliBrokenOutputs : public test::PlvoCommand {
 protected:
  // redirection: of standard output.
  static CommandResult plvo(const std::string& arguments, const std::string& redirection = "") {
    return run_command("sh -c '" + kPlvo + ' ' + arguments + redirection + "'");
  }
  static CommandResult limited(int bytes, const std::string& arguments, const std::string& redirection = "") {
    return run_command("sh -c 'prlimit --fsize=" + std::to_string(bytes) + ' ' + kPlvo + ' ' + arguments +
                       redirection + "'");
  }
  static void expect_failure(const CommandResult& r, const std::string& words) {
    EXPECT_EQ(r.exit_code, 1) << r.err;
    EXPECT_NE(r.err.find("plvo: error: "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find(words), std::string::npos) << r.err;
  }
  static void expect_whole_rows(const std::string& text, const std::string& expected) {
    EXPECT_LT(text.size(), expected.size()) << "the limit was not reached";
    ASSERT_FALSE(text.empty());
    EXPECT_EQ(text, expected.substr(0, text.size()));
    EXPECT_EQ(text.back(), '\n');
  }
};

TEST_F(CliBrokenOutputs, FilesUnderALimitHoldWholeRows) {
  constexpr int kLimit_bytes = 1100;
  const std::string run = "run " + recording() + " --quiet ";
  for (const char* option : {"--covariance ", "--motions "}) {
    ASSERT_EQ(plvo(run + option + path("whole")).exit_code, 0);
    expect_failure(limited(kLimit_bytes, run + option + path("rows")),
                   "rows: File too large; raise the limit on the size of files (ulimit -f)");
    expect_whole_rows(read_file(folder_ / "rows"), read_file(folder_ / "whole"));
    // The shell opens the file at its beginning or at the end of its content.
    test::write_file(folder_ / "appended", "before\n");
    for (const std::string& redirection : {">" + path("into"), ">>" + path("appended")})
      expect_failure(limited(kLimit_bytes, run + option + "-", redirection),
                     "standard output: File too large");
    expect_whole_rows(read_file(folder_ / "into"), read_file(folder_ / "whole"));
    expect_whole_rows(read_file(folder_ / "appended"), "before\n" + read_file(folder_ / "whole"));
  }
  expect_failure(limited(700, run + "--stats " + path("csv")), "csv: File too large");
  std::istringstream rows(read_file(folder_ / "csv"));
  std::string row;
  std::getline(rows, row);
  const auto columns = std::count(row.begin(), row.end(), ',');
  EXPECT_GT(columns, 10);
  while (std::getline(rows, row)) EXPECT_EQ(std::count(row.begin(), row.end(), ','), columns) << row;
  EXPECT_EQ(read_file(folder_ / "csv").back(), '\n');
}

TEST_F(CliBrokenOutputs, FilesWrittenAtTheEndAreWholeOrEmpty) {
  const std::string truth = recording() + "/groundtruth.txt";
  for (const std::string& words :
       {"eval --gt " + truth + " --est " + truth, "run " + recording() + " --quiet --readout 0"}) {
    // A report is larger than its script of 20 kB; the summary is smaller.
    expect_failure(limited(15'000, words + " --report " + path("page") + " --json " + path("json")),
                   "page: File too large");
    EXPECT_EQ(fs::file_size(folder_ / "page"), 0u);
    EXPECT_TRUE(nlohmann::json::accept(read_file(folder_ / "json"))) << words;
    expect_failure(limited(600, words + " --json " + path("json")), "json: File too large");
    EXPECT_EQ(fs::file_size(folder_ / "json"), 0u);
  }
}

TEST_F(CliBrokenOutputs, SummaryGoesToStandardErrorBesideAReportOnStandardOutput) {
  const std::string truth = recording() + "/groundtruth.txt";
  const CommandResult r = plvo("eval --report - --gt " + truth + " --est " + truth);
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_TRUE(r.out.ends_with("</html>\n\n")) << "nothing behind it";
  EXPECT_NE(r.err.find("ATE"), std::string::npos) << r.err;
}

TEST_F(CliBrokenOutputs, SimulatedFolderListsOnlyCompleteImages) {
  const std::string simulate = "simulate --scene bare --size 160x120 --frames 40 --quiet --out ";
  expect_failure(limited(1024, simulate + path("lists")), "File too large");
  expect_failure(limited(10'000, simulate + path("images")), "File too large");
  for (const char* made : {"lists", "images"})
    for (const char* list : {"rgb.txt", "depth.txt"}) {
      const std::string text = read_file(folder_ / made / list);
      ASSERT_FALSE(text.empty());
      EXPECT_EQ(text.back(), '\n');
      std::istringstream rows(text);
      std::string row;
      std::getline(rows, row);  // the comment
      while (std::getline(rows, row))
        EXPECT_GT(fs::file_size(folder_ / made / row.substr(row.find(' ') + 1)), 0u) << row;
    }
}

TEST_F(CliBrokenOutputs, ClosedPipeEndsNoCommandBySignal) {
  const BrokenPipe pipe;
  const std::string truth = recording() + "/groundtruth.txt";
  for (const std::string& words :
       {"run " + recording(), "run " + recording() + " --quiet --out -",
        "run " + recording() + " --quiet --stats -", "run " + recording() + " --quiet --json -",
        "run " + recording() + " --quiet --report -", "eval --gt " + truth + " --est " + truth,
        "eval --json - --gt " + truth + " --est " + truth,
        "simulate --scene bare --size 96x64 --frames 1 --out " + path("one"), std::string("--help"),
        std::string("calibrate --help"), std::string("completion bash"), std::string("man run")})
    expect_failure(plvo(words, pipe.as_output()),
                   "standard output: Broken pipe; the program that reads it has ended");
  // A failure to write progress messages does not change the exit code.
  EXPECT_EQ(plvo("run " + recording() + " --out - >/dev/null 2" + pipe.as_output().substr(1)).exit_code, 0);
}

TEST_F(CliBrokenOutputs, TheOtherOutputsOfARunAreWritten) {
  // The limit applies only to the program; the output that passes through cat has none.
  const CommandResult r =
      run_command("sh -c '{ prlimit --fsize=12000 " + kPlvo + " run " + recording() + " --motions " +
                  path("rows") + " --json " + path("json") + " --report -; echo $? >" + path("code") +
                  "; } | cat >" + path("page") + "'");
  EXPECT_EQ(read_file(folder_ / "code"), "1\n");
  EXPECT_NE(r.err.find("rows: File too large"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("(ended by an error)"), std::string::npos) << "the summary: " << r.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "json"));
  EXPECT_NE(json["failure"].get<std::string>().find("File too large"), std::string::npos);
  EXPECT_GT(json["frames"], 1);
  EXPECT_LT(json["frames"], kTrackedFrames);
  EXPECT_TRUE(read_file(folder_ / "page").ends_with("</html>\n\n"));
  ASSERT_EQ(plvo("run " + recording() + " --quiet --json " + path("json")).exit_code, 0);
  EXPECT_TRUE(nlohmann::json::parse(read_file(folder_ / "json"))["failure"].is_null());
}

}  // namespace
}  // namespace plvo
