// SPDX-License-Identifier: Apache-2.0
// Room for features that tests hold figures, or bits, of: theirs, so that these stand when the product's
// rooms change.
#pragma once

#include "plvo/odometry/config.hpp"

namespace plvo::test {

inline constexpr Limits kTestLimits = {320, 240, 250, 128, 2, 1, 0, 1, 0};

}  // namespace plvo::test
