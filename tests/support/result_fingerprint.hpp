// SPDX-License-Identifier: Apache-2.0
// All that track() says of a frame, but for times and words.
#pragma once

#include "fingerprint.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

inline Fingerprint fingerprint_of(const TrackResult& result) {
  Fingerprint print;
  print.add(static_cast<int>(result.state));
  print.add(static_cast<int>(result.status.code()));
  print.add(result.T_world_camera.R);
  print.add(result.T_world_camera.t);
  print.add(result.pose_covariance);
  print.add(result.T_camera_reference.R);
  print.add(result.T_camera_reference.t);
  print.add(result.motion_covariance);
  for (const FeatureCounts& counts : {result.points, result.lines})
    for (int n : {counts.detected, counts.dropped, counts.with_depth, counts.matched, counts.inliers})
      print.add(n);
  print.add(result.ransac_iterations);
  print.add(result.lm_iterations);
  print.add(result.mean_brightness);
  print.add(result.disagreement);
  return print;
}

inline std::uint64_t fingerprint(const TrackResult& result) { return fingerprint_of(result).value(); }

}  // namespace plvo
