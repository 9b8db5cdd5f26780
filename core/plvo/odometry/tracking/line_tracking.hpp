// SPDX-License-Identifier: Apache-2.0
// Matches the 3D lines of the reference with those of the current frame, near their positions under a motion.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/lines/line_features.hpp"
#include "plvo/lines/line_match.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

// Matches hold indices into the 3D lines of both frames. Lines that the motion puts behind the camera are
// left out. reference_lines: the reference's 3D lines at its mid-exposure; exposure: of the current frame.
void match_predicted_lines(const Pinhole& pinhole, const Exposure& exposure, const LineFeatures& reference,
                           std::span<const Line3d> reference_lines, const LineFeatures& current,
                           const Se3& T_current_reference, const LineMatchConfig& gates, Arena& scratch,
                           FixedVector<Match>& matches);

// Reserves the scratch of match_predicted_lines.
constexpr void reserve_line_tracking(Arena& memory, int segments) {
  const ScratchScope scope(memory);
  const auto n = static_cast<std::size_t>(segments);
  memory.take<Segment>("predicted segments", n);
  take_line_match_scratch(memory, n, n);
}

}  // namespace plvo
