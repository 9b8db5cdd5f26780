// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/current_frame.hpp"

namespace plvo {

// Not inlined: the sampler would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] void CurrentFrame::find_points() const {
  extraction.find_points(context, depth.with(predicted.exposure), features.points);
}

void CurrentFrame::describe_points() const {
  find_points();
  extraction.describe_points(context, features.points);
}

void CurrentFrame::lift_as_reference(const Exposure& exposure, bool described) const {
  if (described)
    describe_points();
  else
    find_points();
  extraction.lift(context, depth.with(exposure), features);
}

}  // namespace plvo
