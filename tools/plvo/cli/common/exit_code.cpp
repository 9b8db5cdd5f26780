// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/exit_code.hpp"

#include <fmt/core.h>

#include <cstdio>

namespace plvo::cli {

int fail(const Status& status) { return fail(std::string_view(status.message())); }

int fail(std::string_view message) {
  fmt::print(stderr, "plvo: error: {}\n", message);
  return kExitFailure;
}

void warn(std::string_view message) { fmt::print(stderr, "plvo: warning: {}\n", message); }

}  // namespace plvo::cli
