// SPDX-License-Identifier: Apache-2.0
// Finds the features that travel with the camera (carried_cells.hpp), in three ways.
//
// 1. The estimate is right. Features that its motion should have moved in the image are searched at the
//    pixels where they were. Each reference votes.
// 2. Most of the features travel with the camera, and the estimate says that the camera stands still. The
//    features that did not stay at their pixels tell: they agree on one motion, and they lie between those
//    that stayed. Both groups seem to lie on the same surface, which has only one motion. So one group is no
//    part of the surface but light, such as a projector's dots or a reflection. It is the group that stayed:
//    light that comes from the robot travels with the camera.
// 3. The estimate says the same, but little is found of the rest of the scene, which a camera at rest would
//    find again. What stayed is a part of the robot.
#pragma once

#include <span>

#include "plvo/odometry/tracking/current_frame.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/points/carried_cells.hpp"

namespace plvo {

// Votes by the keypoints of a reference: those that the motion moves by a few pixels.
void vote_for_carried(const CurrentFrame& current, const PointFeatures& points, const ReferenceTracks& tracks,
                      const Se3& T_current_reference, CarriedCells& cells);

// Leaves out the edges of a part of the robot: lines in carried cells that stayed at their pixels, if most of
// the other matches moved. (Lines in carried cells that moved belong to a scene on which light is thrown.)
void leave_carried_lines_out(std::span<const Reference> references, const LineFeatures& current,
                             const CarriedCells& cells, std::span<ReferenceTracks> tracks);

// The matches of an estimate, by whether they stayed at their pixels.
struct StayedMatches {
  CarriedCells::Counts cells{};        // points that stayed
  int stayed = 0, stayed_inliers = 0;  // points
  int other_depth = 0;                 // of those that stayed: their depth has changed
  int others = 0, other_inliers = 0;   // points that did not stay, and lines
};
StayedMatches count_stayed(std::span<const Reference> references, std::span<const ReferenceTracks> tracks,
                           const CarriedCells& cells);
// Whether the estimate may be misled: most points stayed, and most other matches disagree.
bool may_be_misled(const StayedMatches& before);
// Whether nearly all matches are points that stayed, so that the camera seems to stand still,
// although this explains too little of the scene. A camera at rest finds more of it again.
bool contradicts_rest(const StayedMatches& before, double explained);
// Whether many points stayed at their pixels although their depths changed: they are light, not places on a
// surface.
bool depth_contradicts(const StayedMatches& before);
// Moves the points that stayed to the end of the tracks and leaves them out. Returns the size before.
std::size_t leave_stayed_out(const Reference& reference, ReferenceTracks& tracks);
// Whether the other matches agree on a motion of their own and lie among the points that stayed. tracks: with
// the flags of an estimate from the other matches alone.
bool agree_among_stayed(const StayedMatches& before, std::span<const Reference> references,
                        std::span<const ReferenceTracks> tracks, const CameraModel& camera,
                        const CarriedCells& cells);

}  // namespace plvo
