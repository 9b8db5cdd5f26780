// SPDX-License-Identifier: Apache-2.0
#include "run_tests.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <string>

namespace {

std::string name_of_file(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

// Returns false if one of the files contains no test, or if a test is in a file that no ctest entry can name.
bool select_tests_of(std::set<std::string> files) {
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
    filter += all ? std::string(suite.name()) + ".*:" : tests;  // short: GoogleTest prints it
  }
  for (const std::string& file : files) std::fprintf(stderr, "there is no test in %s\n", file.c_str());
  testing::GTEST_FLAG(filter) = filter;
  return files.empty();
}

}  // namespace

namespace plvo::test {

int run_tests(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::set<std::string> files;
  for (int i = 1; i < argc; ++i) files.insert(name_of_file(argv[i]));
  if (!files.empty() && !select_tests_of(files)) return 1;
  const int failed = RUN_ALL_TESTS();
  if (failed != 0) return failed;
  const testing::UnitTest& program = *testing::UnitTest::GetInstance();
  if (program.test_to_run_count() == 0 && !testing::GTEST_FLAG(list_tests)) {
    std::fprintf(stderr, "there was no test to run\n");
    return 1;
  }
  return program.skipped_test_count() > 0 ? 77 : 0;
}

}  // namespace plvo::test
