// SPDX-License-Identifier: Apache-2.0
// If the machine has less memory than an input needs, the program reports it.
#include <gtest/gtest.h>

#include <string>

#include "command.hpp"
#include "peak_memory.hpp"
#include "plvo_binary.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

TEST(CliMemory, ReportsAFailedAllocation) {
  if (!test::kMemoryIsTold) GTEST_SKIP() << "SKIPPED: a sanitizer maps more than any limit allows";
  const test::TemporaryFolder folder;
  std::string rows;
  for (int i = 1; i <= 1'000'000; ++i) rows += std::to_string(i) + " 0 0 0 0 0 0 1\n";
  test::write_file(folder / "t.txt", rows);
  const std::string file = (folder / "t.txt").string();
  const test::CommandResult r =
      test::run_command("ulimit -v 180000; exec " + test::kPlvo + " eval --gt " + file + " --est " + file);
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.err.find("plvo: error: there is not enough memory: what is read of a file takes up to 512 MiB"),
            std::string::npos)
      << r.err;
}

}  // namespace
}  // namespace plvo
