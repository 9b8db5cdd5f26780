// SPDX-License-Identifier: Apache-2.0
// Box L4 of the paper, matching: robust nearest neighbours in descriptor space. A pair must agree with the
// prediction (direction with its sign, distance, overlap), must be mutual nearest neighbours, and must be
// clearly nearer than any rival. A fragment of the same broken line does not count as a rival.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/lines/msld.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

// The defaults are for a motion that is only predicted. A lost frame widens the second.
struct LineMatchConfig {
  double max_angle_rad = 0.2;  // between predicted and current direction
  // Limit of the distance across the predicted segment, at the middle of the current one. The same slack
  // applies along it.
  double max_offset_px = 40;
  double min_overlap = 0.5;  // share of the shorter one's length
  int max_distance = 35000;  // limit of the squared descriptor distance
  double max_ratio = 0.85;   // limit of best / second best distance, not squared
  // A rival is a fragment of the best one's line if it is within this distance and angle of it.
  double same_line_px = 3;
  double same_line_rad = 0.07;

  // Settings for a motion that is known.
  static constexpr LineMatchConfig guided() { return {.max_angle_rad = 0.1, .max_offset_px = 8}; }
};

// Pose of one segment.
struct LinePose {
  float x, y;         // middle
  float ux, uy;       // direction
  float half_length;  // px
};

struct LineCandidate {
  std::uint16_t index;
  int distance;
};

struct LineMatchScratch {
  std::span<LinePose> current;
  std::span<std::int16_t> directions;  // directions of the current segments: ux and uy interleaved, 2^-14
  std::span<LineCandidate> candidates, best_of_current;
  std::span<std::uint16_t> best_of_reference;
};
constexpr LineMatchScratch take_line_match_scratch(Arena& memory, std::size_t references,
                                                   std::size_t currents) {
  return {memory.take<LinePose>("line match", currents),
          memory.take<std::int16_t>("line match", (currents + 3) / 4 * 8),
          memory.take<LineCandidate>("line match", currents),
          memory.take<LineCandidate>("line match", currents),
          memory.take<std::uint16_t>("line match", references)};
}

// Projects the line between two points in the current camera's frame, for match_lines. Only the ends of the
// segment are set. A line that reaches behind the camera is placed far outside the image, where it has no
// match.
Segment project_line(const Pinhole& pinhole, const Vector3& a, const Vector3& b);

// predicted: the reference segments at their predicted positions in the current image (or at their old
// positions, with wide gates). Matches follow the order of the reference segments. Each side has at most
// 65535 segments. The function computes at most |predicted| · |current| descriptor distances.
void match_lines(std::span<const Segment> predicted, std::span<const LineDescriptor> reference_descriptors,
                 std::span<const Segment> current, std::span<const LineDescriptor> current_descriptors,
                 const LineMatchConfig& config, Arena& scratch, FixedVector<Match>& matches);

}  // namespace plvo
