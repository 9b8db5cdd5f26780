// SPDX-License-Identifier: Apache-2.0
// The built program plvo, for tests that run it.
#pragma once

#include <string>

namespace plvo::test {

inline const std::string kPlvo = PLVO_BINARY;

}  // namespace plvo::test
