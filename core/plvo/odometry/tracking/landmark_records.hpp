// SPDX-License-Identifier: Apache-2.0
// Keeps the records of the references' landmarks (landmark_record.hpp). A landmark that was found but does
// not agree with the motion of the frame moves by itself. Without records, a moving object would have the
// same weight in each new reference as the room, and the estimate would follow it as soon as it fills enough
// of the image.
#pragma once

#include <span>

#include "plvo/odometry/tracking/current_frame.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/odometry/window/window.hpp"

namespace plvo {

// Takes a tracked frame into the records of a reference. tracks: its matches with the frame, with the flags
// of the frame's estimate.
void note_records(const ReferenceTracks& tracks, FrameFeatures& reference);

// Gives records to the landmarks of the current frame, which becomes a reference. One that is a landmark of a
// reference again keeps its record. Any other gets the mean record of the landmarks that were found in the
// same part of the image; if this is negative, the new landmark is not trusted at first. references: their
// slots in the window. tracking: the frame's matches with them. Scratch: not more than that of match_points.
void inherit_records(const Window& window, std::span<const int> references, const ReferenceTracking& tracking,
                     const CurrentFrame& current);

}  // namespace plvo
