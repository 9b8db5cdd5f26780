// SPDX-License-Identifier: Apache-2.0
// Whether a failure is told in the words that its reader needs.
#pragma once

#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo::test {

inline bool says(const Status& status, std::string_view words) {
  return std::string_view(status.message()).find(words) != std::string_view::npos;
}

}  // namespace plvo::test
