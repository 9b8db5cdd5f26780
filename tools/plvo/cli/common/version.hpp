// SPDX-License-Identifier: Apache-2.0
// What this program is: version, commit and build. Its source is made while building, by
// tools/cmake/commit.cmake.
#pragma once

namespace plvo::cli {

// Lines without a last newline, the first of them "plvo 0.1.0".
extern const char* const kVersionText;

}  // namespace plvo::cli
