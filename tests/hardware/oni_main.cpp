// SPDX-License-Identifier: Apache-2.0
// A test program that plays .oni files by starting itself as its child process.
#include <gtest/gtest.h>

#include "plvo/openni2/openni2_camera.hpp"

int main(int argc, char** argv) {
  if (const std::optional<int> played = plvo::play_oni_if_asked(argc, argv)) return *played;
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
