// SPDX-License-Identifier: Apache-2.0
// A test program that plays .oni files by starting itself as its child process.
#include "plvo/openni2/openni2_camera.hpp"
#include "run_tests.hpp"

int main(int argc, char** argv) {
  if (const std::optional<int> played = plvo::play_oni_if_asked(argc, argv)) return *played;
  return plvo::test::run_tests(argc, argv);
}
