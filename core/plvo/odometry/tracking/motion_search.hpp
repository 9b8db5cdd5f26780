// SPDX-License-Identifier: Apache-2.0
// The search for the motion of a frame: first motions are tried one after the other, until one explains the
// features that it puts into the image. For each, features are associated and the motion is estimated
// (reference_tracking.hpp).
#pragma once

#include "plvo/odometry/tracking/reference_tracking.hpp"

namespace plvo {

// Returns the motion from the base, the first of the references that were predicted. The first motion comes
// from the latest reference, by image alignment; if that fails, from features: first near the prediction,
// then from each reference over a wide area, around the propagated prior if there is one. Each first motion
// is refined with all references. The first that explains enough of the view is taken, else the one with most
// inliers.
TrackedMotion search_motion(const CurrentFrame& current, ReferenceTracking& tracking);

}  // namespace plvo
