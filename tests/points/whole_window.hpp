// SPDX-License-Identifier: Apache-2.0
// The depth mask of a keypoint whose window shows only its own surface.
#pragma once

#include "plvo/points/keypoint.hpp"

namespace plvo::test {

inline constexpr WindowMask kWholeWindow = {255, 255, 255, 255, 255, 255, 255, 255, 255};

}  // namespace plvo::test
