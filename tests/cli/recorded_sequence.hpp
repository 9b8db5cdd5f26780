// SPDX-License-Identifier: Apache-2.0
// The folder that the bags are made from.
#pragma once

#include "simulated_sequence.hpp"

namespace plvo::test {

inline const std::filesystem::path& recorded_sequence() { return simulated_sequence<6>(); }

}  // namespace plvo::test
