// SPDX-License-Identifier: Apache-2.0
#include "run_tests.hpp"

int main(int argc, char** argv) { return plvo::test::run_tests(argc, argv); }
