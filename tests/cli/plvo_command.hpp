// SPDX-License-Identifier: Apache-2.0
// Runs the built program; fixture of the tests that do: a folder for its files, and the check of a refusal.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "command.hpp"
#include "plvo_binary.hpp"
#include "temporary_folder.hpp"

namespace plvo::test {

inline CommandResult run_plvo(const std::string& arguments) { return run_command(kPlvo + ' ' + arguments); }

class PlvoCommand : public ::testing::Test {
 protected:
  static CommandResult plvo(const std::string& arguments) { return run_plvo(arguments); }
  static void expect_refused(const CommandResult& result, int exit_code, std::string_view words) {
    EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

}  // namespace plvo::test
