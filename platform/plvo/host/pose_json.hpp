// SPDX-License-Identifier: Apache-2.0
// A pose as one line of JSON, for programs that are not ours. Keys: stamp_ns, state, status, message,
// position (m), orientation_xyzw, covariance (36 numbers, row-major: position, then orientation; axes of the
// world), points, lines.
#pragma once

#include <string>
#include <string_view>

#include "plvo/odometry/track_result.hpp"

namespace plvo {

std::string pose_json(const TrackResult& result);

// The text within quotes, with what JSON forbids escaped; bytes that are not ASCII become "?".
std::string json_string(std::string_view text);

}  // namespace plvo
