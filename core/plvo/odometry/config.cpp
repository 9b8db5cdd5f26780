// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/config.hpp"

namespace plvo {
namespace {

Status out_of_range(const char* entry, const char* range) {
  return Status(StatusCode::kInvalidArgument, "config: ").append(entry).append(" must be ").append(range);
}

// False for NaN as well.
bool within(double value, double low, double high) { return value >= low && value <= high; }

Status validate(const DepthNoise& noise) {
  if (!within(noise.c1, -1, 1) || !within(noise.c2, -1, 1) || !within(noise.c3, -1, 1))
    return out_of_range("depth_noise c1, c2, c3", "between -1 and 1 (metres)");
  if (!within(noise.floor_m, 1e-6, 1)) return out_of_range("depth_noise.floor_m", "between 1e-6 and 1");
  if (!within(noise.registration_px, 0, 20)) return out_of_range("depth_noise.registration_px", "0 to 20");
  return {};
}

Status validate(const PointConfig& points) {
  if (!within(points.sigma_px, 0.01, 20)) return out_of_range("points.sigma_px", "between 0.01 and 20");
  if (!within(points.pyramid_levels, 1, 4)) return out_of_range("points.pyramid_levels", "1 to 4");
  if (!within(points.cell_px, 24, 64)) return out_of_range("points.cell_px", "24 to 64");
  if (!within(points.noise_floor, 1, 64)) return out_of_range("points.noise_floor", "1 to 64");
  if (!within(points.min_strength, 0, 1e5)) return out_of_range("points.min_strength", "0 to 100000");
  if (!within(points.search_radius_px, 1, 1000)) return out_of_range("points.search_radius_px", "1 to 1000");
  if (!within(points.max_distance, 0, 256)) return out_of_range("points.max_distance", "0 to 256");
  if (!within(points.max_ratio, 0.1, 1)) return out_of_range("points.max_ratio", "between 0.1 and 1");
  return {};
}

Status validate(const Line3dConfig& fit) {
  if (!within(fit.max_samples, 2, kMaxLineSamples)) return out_of_range("lines.fit.max_samples", "2 to 100");
  if (!within(fit.min_consensus, 0, 1)) return out_of_range("lines.fit.min_consensus", "0 to 1");
  if (!within(fit.min_agreement, 0, 1)) return out_of_range("lines.fit.min_agreement", "0 to 1");
  if (!within(fit.sigma_p_px, 0.01, 20)) return out_of_range("lines.fit.sigma_p_px", "between 0.01 and 20");
  if (!within(fit.inlier_chi_square, 0.1, 100))
    return out_of_range("lines.fit.inlier_chi_square", "0.1 to 100");
  if (!within(fit.max_ransac_iterations, 1, 1000))
    return out_of_range("lines.fit.max_ransac_iterations", "1 to 1000");
  if (!within(fit.side_reach_px, 0, kMaxSideReach)) return out_of_range("lines.fit.side_reach_px", "0 to 5");
  if (!within(fit.depth_correlation_px, 0.01, 1000))
    return out_of_range("lines.fit.depth_correlation_px", "between 0.01 and 1000");
  if (!within(fit.transverse_floor_px, 0, 20))
    return out_of_range("lines.fit.transverse_floor_px", "0 to 20");
  return {};
}

Status validate(const LineMatchConfig& match) {
  if (!within(match.max_angle_rad, 0, 4)) return out_of_range("lines.match.max_angle_rad", "0 to 4");
  if (!within(match.max_offset_px, 0, 4000)) return out_of_range("lines.match.max_offset_px", "0 to 4000");
  if (!within(match.min_overlap, 0, 1)) return out_of_range("lines.match.min_overlap", "0 to 1");
  if (!within(match.max_distance, 0, 300000)) return out_of_range("lines.match.max_distance", "0 to 300000");
  if (!within(match.max_ratio, 0, 1)) return out_of_range("lines.match.max_ratio", "0 to 1");
  return {};
}

Status validate(const LineConfig& lines) {
  if (Status status = validate(lines.fit); !status.ok()) return status;
  if (Status status = validate(lines.match); !status.ok()) return status;
  if (!within(lines.guided_offset_px, 0, 4000)) return out_of_range("lines.guided_offset_px", "0 to 4000");
  if (!within(lines.guided_angle_rad, 0, 4)) return out_of_range("lines.guided_angle_rad", "0 to 4");
  return {};
}

Status validate(const MotionConfig& motion) {
  if (!within(motion.inlier_probability, 0.5, 0.99999))
    return out_of_range("motion.inlier_probability", "between 0.5 and 0.99999");
  if (!within(motion.max_ransac_iterations, 1, 100000))
    return out_of_range("motion.max_ransac_iterations", "1 to 100000");
  if (!within(motion.min_inliers, 3, 10000)) return out_of_range("motion.min_inliers", "3 to 10000");
  if (!within(motion.wide_search_px, 1, 4000)) return out_of_range("motion.wide_search_px", "1 to 4000");
  if (!within(motion.keyframe_inlier_ratio, 0, 1))
    return out_of_range("motion.keyframe_inlier_ratio", "0 to 1");
  if (!within(motion.max_lost_frames, 1, 1000000))
    return out_of_range("motion.max_lost_frames", "1 to 1000000");
  if (!within(motion.unseen_m_per_s, 0, 100) || !within(motion.unseen_rad_per_s, 0, 100))
    return out_of_range("motion.unseen_m_per_s, unseen_rad_per_s", "0 to 100");
  return {};
}

}  // namespace

Status Limits::validate() const {
  if (!within(width, 64, 2047) || !within(height, 64, 2047))
    return out_of_range("Limits width and height", "64 to 2047");
  if (!within(keypoints, 10, 60000)) return out_of_range("Limits::keypoints", "10 to 60000");
  if (!within(segments, 1, 60000)) return out_of_range("Limits::segments", "1 to 60000");
  return {};
}

Status Config::validate() const {
  if (Status status = plvo::validate(depth_noise); !status.ok()) return status;
  if (Status status = plvo::validate(points); !status.ok()) return status;
  if (Status status = plvo::validate(lines); !status.ok()) return status;
  return plvo::validate(motion);
}

Config Config::paper() {
  Config config;
  config.features = Features::kBoth;
  config.reference = ReferencePolicy::kPreviousFrame;
  config.depth_noise.registration_px = 0;
  config.lines.fit = Line3dConfig::paper();
  config.motion.robust = false;
  config.lines.fit = Line3dConfig::paper();
  return config;
}

}  // namespace plvo
