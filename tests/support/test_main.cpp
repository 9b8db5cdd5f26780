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

// False when one of the files holds no test, or a test is nobody's.
bool run_what_stands_in(std::set<std::string> files) {
  const testing::UnitTest& program = *testing::UnitTest::GetInstance();
  const std::set<std::string> named = files;
  std::string filter;
  for (int i = 0; i < program.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *program.GetTestSuite(i);
    std::string tests;
    bool all = true;
    for (int k = 0; k < suite.total_test_count(); ++k) {
      const testing::TestInfo& test = *suite.GetTestInfo(k);
      const std::string file = name_of_file(test.file());
      if (!file.ends_with("_test.cpp")) {
        std::fprintf(stderr, "%s:%d: no entry of ctest runs a test that is not in a file *_test.cpp\n",
                     test.file(), test.line());
        return false;
      }
      if (named.contains(file)) tests += std::string(suite.name()) + '.' + test.name() + ':';
      if (!named.contains(file)) all = false;
      files.erase(file);
    }
    filter += all ? std::string(suite.name()) + ".*:" : tests;  // short, for it is printed
  }
  for (const std::string& file : files) std::fprintf(stderr, "there is no test in %s\n", file.c_str());
  testing::GTEST_FLAG(filter) = filter;
  return files.empty();
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::set<std::string> files;
  for (int i = 1; i < argc; ++i) files.insert(name_of_file(argv[i]));
  if (!files.empty() && !run_what_stands_in(files)) return 1;
  const int failed = RUN_ALL_TESTS();
  if (failed != 0) return failed;
  const testing::UnitTest& program = *testing::UnitTest::GetInstance();
  if (program.test_to_run_count() == 0 && !testing::GTEST_FLAG(list_tests)) {
    std::fprintf(stderr, "there was no test to run\n");
    return 1;
  }
  return program.skipped_test_count() > 0 ? 77 : 0;
}
