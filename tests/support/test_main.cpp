// SPDX-License-Identifier: Apache-2.0
// The main of every test program. It ends with 77 when nothing failed but a test had to be skipped: ctest,
// which sees the program alone, then lists it as skipped and not as passed. Given the names of source files
// it runs what stands in them: several entries of ctest share a program. That no test be left out in silence,
// it fails when there is nothing to run, and when a test stands in a file that no entry can name.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <string>

namespace {

std::string name_of_file(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

// Takes what stands in other files out of the filter; false when a file is not the program's, or a test is
// nobody's.
bool run_only(const std::set<std::string>& files) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  std::set<std::string> missing = files;
  std::string others;
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k) {
      const testing::TestInfo& test = *suite.GetTestInfo(k);
      const std::string file = name_of_file(test.file());
      if (!file.ends_with("_test.cpp")) {
        std::fprintf(stderr, "%s:%d: tests stand in files *_test.cpp, or ctest does not run them\n",
                     test.file(), test.line());
        return false;
      }
      missing.erase(file);
      if (!files.contains(file)) others += std::string(":") + suite.name() + '.' + test.name();
    }
  }
  for (const std::string& file : missing)
    std::fprintf(stderr, "this program has no test in %s\n", file.c_str());
  std::string& filter = testing::GTEST_FLAG(filter);
  if (!others.empty() && filter.find('-') == std::string::npos) filter += '-';
  filter += others;
  return missing.empty();
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::set<std::string> files;
  for (int i = 1; i < argc; ++i) files.insert(name_of_file(argv[i]));
  if (!files.empty() && !run_only(files)) return 1;
  const int failed = RUN_ALL_TESTS();
  if (failed != 0) return failed;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  if (all.test_to_run_count() == 0 && !testing::GTEST_FLAG(list_tests)) {
    std::fprintf(stderr, "there was no test to run\n");
    return 1;
  }
  return all.skipped_test_count() > 0 ? 77 : 0;
}
