// SPDX-License-Identifier: Apache-2.0
// The main function of the test programs. Arguments that are names of test files select the tests of these
// files: the ctest entries of several files share a program. Returns 77 if nothing failed and a test was
// skipped: ctest then lists the entry as skipped and not as passed. Fails if there is no test to run, and if
// a test is in a file that no ctest entry can name.
#pragma once

namespace plvo::test {

int run_tests(int argc, char** argv);

}  // namespace plvo::test
