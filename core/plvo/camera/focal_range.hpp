// SPDX-License-Identifier: Apache-2.0
// The focal lengths that are accepted, in pixels. Cameras have some hundred or thousand; what lies outside is
// a mistake in the calibration.
#pragma once

namespace plvo {

inline constexpr int kLeastFocal_px = 1, kMostFocal_px = 100'000;

}  // namespace plvo
