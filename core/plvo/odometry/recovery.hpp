// SPDX-License-Identifier: Apache-2.0
// Relocalisation after a loss, when the view of a kept keyframe comes back. Descriptors are matched over the
// whole image, whatever the predicted pose; the motion is then registered and judged as usual. It
// is accepted under two conditions. First, as large a share of the keyframe's features are inliers
// as a keyframe needs to stay in use. Second, the resulting pose lies within the process noise of
// the unobserved motion, so that a similar view elsewhere is rejected.
#pragma once

#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/odometry/window/window.hpp"

namespace plvo {

// Whether at least this share of the features of a reference are inliers of the last estimate.
bool still_seen(const FrameFeatures& reference, const ReferenceTracks& tracks, double share);

// Matches the current frame, which moves at this velocity, with a kept keyframe. believed: its pose without
// the relocalisation. Returns whether the motion from the keyframe, in `tracked`, is accepted.
bool recognise(const Window::Frame& keyframe, const CurrentFrame& frame, const Vector6& velocity,
               const PoseWithCovariance& believed, ReferenceTracking& tracking, TrackedMotion& tracked);

// Decides in which frames the view of a kept keyframe is searched while tracking goes on.
class RelocalisationTurn {
 public:
  bool is_due(const KeptKeyframes& kept) const { return !kept.empty() && frames_since_ + 1 >= kInterval; }
  // Counts a frame; returns whether it is its turn.
  bool take(const KeptKeyframes& kept) {
    const bool due = is_due(kept);
    if (!kept.empty()) frames_since_ = due ? 0 : frames_since_ + 1;
    return due;
  }
  void forget() { frames_since_ = 0; }

 private:
  // Frames from one search to the next. A search matches descriptors over the whole image, which takes too
  // long for every frame.
  static constexpr int kInterval = 5;

  int frames_since_ = 0;
};

}  // namespace plvo
