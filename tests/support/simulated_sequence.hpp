// SPDX-License-Identifier: Apache-2.0
// A short sequence of a simulated room, recorded by the program under test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "command.hpp"
#include "plvo_binary.hpp"

namespace plvo::test {

// Made once for all tests of a program: one that changes it works on a copy.
template <int kFrames>
const std::filesystem::path& simulated_sequence() {
  static const TemporaryFolder folder;
  static const std::filesystem::path sequence = [] {
    const CommandResult made =
        run_command(kPlvo + " simulate --scene bare --size 160x120 --seed 3 --quiet --frames " +
                    std::to_string(kFrames) + " --out " + (folder / "sequence").string());
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return folder / "sequence";
  }();
  return sequence;
}

}  // namespace plvo::test
