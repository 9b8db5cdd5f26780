// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/exit_code.hpp"

#include "plvo/host/stderr_log.hpp"

namespace plvo::cli {

int fail(const Status& status) { return fail(std::string_view(status.message())); }

int fail(std::string_view message) {
  StderrLog().write(LogLevel::kError, message);
  return kExitFailure;
}

void warn(std::string_view message) { StderrLog().write(LogLevel::kWarning, message); }

}  // namespace plvo::cli
