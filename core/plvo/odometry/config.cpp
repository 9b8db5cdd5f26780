// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/config.hpp"

#include "plvo/base/build.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/odometry/kept_keyframes.hpp"

namespace plvo {
namespace {

Status out_of_range(const char* entry, const char* range) {
  return Status(StatusCode::kInvalidArgument, "config: ").append(entry).append(" must be ").append(range);
}

// A kind of features that this build of the core leaves out.
Status validate(Features features) {
  if (!kLinesBuilt && features != Features::kPoints)
    return {StatusCode::kUnsupported,
            "config: features must be kPoints: this build is without lines (CMake: PLVO_FEATURES)"};
  if (!kPointsBuilt && features != Features::kLines)
    return {StatusCode::kUnsupported,
            "config: features must be kLines: this build is without points (CMake: PLVO_FEATURES)"};
  return {};
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
  const DetectorConfig& detector = points.detector;
  if (!within(points.sigma_px, 0.01, 20)) return out_of_range("points.sigma_px", "between 0.01 and 20");
  if (!within(points.depth_reach_px, 0, DepthSampler::kMaxRadius))
    return out_of_range("points.depth_reach_px", "0 to 3");
  if (!within(detector.levels, 1, 4)) return out_of_range("points.detector.levels", "1 to 4");
  if (!within(detector.cell_px, kMinCell, kMaxCell))
    return out_of_range("points.detector.cell_px", "24 to 64");
  if (!within(detector.noise_floor, 1, 64)) return out_of_range("points.detector.noise_floor", "1 to 64");
  if (!within(detector.min_strength, 0, 1e5))
    return out_of_range("points.detector.min_strength", "0 to 100000");
  if (!within(points.match.radius_px, 1, 1000)) return out_of_range("points.match.radius_px", "1 to 1000");
  if (!within(points.match.max_distance, 0, 256))
    return out_of_range("points.match.max_distance", "0 to 256");
  if (!within(points.match.max_ratio, 0.1, 1))
    return out_of_range("points.match.max_ratio", "between 0.1 and 1");
  return {};
}

Status validate(const NoiseConfig& noise) {
  if (!within(noise.initial.image, 0.01, 100) || !within(noise.initial.depth, 0.01, 100) ||
      !within(noise.initial.lines, 0.01, 100) || !within(noise.initial.surfaces, 0.01, 100))
    return out_of_range("noise.initial image, depth, lines, surfaces", "between 0.01 and 100");
  if (!within(noise.learning_rate, 0, 0.5)) return out_of_range("noise.learning_rate", "0 to 0.5");
  if (!within(noise.initial.turning, 0.01, 100) || !within(noise.initial.shared_depth, 0.01, 100))
    return out_of_range("noise.initial turning, shared_depth", "between 0.01 and 100");
  if (!within(noise.turning_rad_per_s, 0, 10) || !within(noise.shared_depth_m, 0, 1))
    return out_of_range("noise.turning_rad_per_s, shared_depth_m", "0 to 10 rad/s, 1 m");
  if (!within(noise.point_correlation, 0, 1) || !within(noise.line_correlation, 0, 1) ||
      !within(noise.surface_correlation, 0, 1))
    return out_of_range("noise.point_correlation, line_correlation, surface_correlation", "0 to 1");
  if (!within(noise.depth_moment_s, 0, 1) || !within(noise.depth_offset_m, 0, 1))
    return out_of_range("noise.depth_moment_s, depth_offset_m", "0 to 1 s, 1 m");
  return {};
}

Status validate(const Line3dConfig& fit) {
  if (!within(fit.max_samples, 2, kMaxLineSamples)) return out_of_range("lines.fit.max_samples", "2 to 100");
  if (!within(fit.sample_spacing_px, 1, 1000))
    return out_of_range("lines.fit.sample_spacing_px", "1 to 1000");
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
  if (!within(motion.ransac_confidence, 0.5, 0.999999))
    return out_of_range("motion.ransac_confidence", "between 0.5 and 0.999999");
  if (!within(motion.min_inlier_ratio, 0, 1)) return out_of_range("motion.min_inlier_ratio", "0 to 1");
  if (!within(motion.max_sigma_m, 1e-6, 100) || !within(motion.max_sigma_rad, 1e-6, 10))
    return out_of_range("motion.max_sigma_m, max_sigma_rad", "between 1e-6 and 100 m, 10 rad");
  return {};
}

Status validate(const ReferenceConfig& references) {
  if (!within(references.wide_search_px, 1, 4000))
    return out_of_range("references.wide_search_px", "1 to 4000");
  if (!within(references.keyframe_inlier_ratio, 0, 1))
    return out_of_range("references.keyframe_inlier_ratio", "0 to 1");
  if (!within(references.max_lost_frames, 1, 1000000))
    return out_of_range("references.max_lost_frames", "1 to 1000000");
  if (!within(references.unseen_m_per_s, 0, 100) || !within(references.unseen_rad_per_s, 0, 100))
    return out_of_range("references.unseen_m_per_s, unseen_rad_per_s", "0 to 100");
  if (!within(references.look_back_frames, 1, 1000000))
    return out_of_range("references.look_back_frames", "1 to 1000000");
  return {};
}

Status validate(const BudgetConfig& budget) {
  if (!within(static_cast<double>(budget.frame_ns), 0, 1e12))
    return out_of_range("budget.frame_ns", "0 to 1e12");
  if (!within(budget.patience_frames, 1, 1000000))
    return out_of_range("budget.patience_frames", "1 to 1000000");
  if (!within(budget.spare_share, 0, 1)) return out_of_range("budget.spare_share", "0 to 1");
  return {};
}

}  // namespace

Status Limits::validate() const {
  if (!within(width, 64, 2047) || !within(height, 64, 2047))
    return out_of_range("Limits width and height", "64 to 2047");
  if (!within(keypoints, 10, 60000)) return out_of_range("Limits::keypoints", "10 to 60000");
  if (!within(segments, 1, 60000)) return out_of_range("Limits::segments", "1 to 60000");
  if (!within(kept_keyframes, 0, kMostKeptKeyframes)) return out_of_range("Limits::kept_keyframes", "0 to 4");
  if (!within(references, 1, 2)) return out_of_range("Limits::references", "1 or 2");
  if (!within(surfaces, 0, 1000)) return out_of_range("Limits::surfaces", "0 to 1000");
  if (!within(cores, 1, 2)) return out_of_range("Limits::cores", "1 or 2");
  if (!within(line_bands, 1, 8)) return out_of_range("Limits::line_bands", "1 to 8");
  return {};
}

Status Config::validate() const {
  if (Status status = plvo::validate(features); !status.ok()) return status;
  if (Status status = plvo::validate(depth_noise); !status.ok()) return status;
  if (Status status = plvo::validate(points); !status.ok()) return status;
  if (Status status = plvo::validate(lines); !status.ok()) return status;
  if (Status status = plvo::validate(noise); !status.ok()) return status;
  if (Status status = plvo::validate(references); !status.ok()) return status;
  if (Status status = plvo::validate(budget); !status.ok()) return status;
  return plvo::validate(motion);
}

Config Config::paper() {
  Config config;
  config.surfaces = false;
  config.references.policy = ReferencePolicy::kPreviousFrame;
  config.depth_noise.registration_px = 0;
  config.noise = {.initial = {},
                  .learning_rate = 0,
                  .turning_rad_per_s = 0,
                  .shared_depth_m = 0,
                  .point_correlation = 0,
                  .line_correlation = 0};
  config.points.registered = false;
  config.points.sigma_px = 1;
  config.points.depth_reach_px = 0;
  config.lines.fit = Line3dConfig::paper();
  config.motion.robust = false;
  return config;
}

Config Config::tiny() {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  return config;
}

}  // namespace plvo
