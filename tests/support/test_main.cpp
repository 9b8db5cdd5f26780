// SPDX-License-Identifier: Apache-2.0
// The main of every test program. It ends with 77 when nothing failed but a test had to be skipped: ctest,
// which sees the program alone, then lists it as skipped and not as passed.
#include <gtest/gtest.h>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  if (failed != 0) return failed;
  return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? 77 : 0;
}
