// SPDX-License-Identifier: Apache-2.0
// The folder that the bags are made of.
#pragma once

#include "simulated_walk.hpp"

namespace plvo::test {

inline const std::filesystem::path& walk() { return simulated_walk<6>(); }

}  // namespace plvo::test
