// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/config.hpp"

#include <algorithm>

#include "plvo/image/depth_sampler.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/odometry/window/kept_keyframes.hpp"

namespace plvo {
namespace {

// Keeps the first number that is outside its range. Each range appears once; the message is built from it.
class RangeCheck {
 public:
  // Sets the group that the following entries belong to.
  void group(const char* name) { group_ = name; }

  // Both bounds are allowed; NaN is not.
  void require(const char* entry, double value, double low, double high) {
    if (!status_.ok() || (value >= low && value <= high)) return;
    status_ = Status(StatusCode::kInvalidArgument, "config: ")
                  .append(group_)
                  .append(entry)
                  .append(" must lie between ");
    append_bound(low);
    status_.append(" and ");
    append_bound(high);
  }
  // Overloads for whole numbers take fewer instructions at the call.
  void require(const char* entry, double value, int low, int high) {
    require(entry, value, static_cast<double>(low), static_cast<double>(high));
  }
  void require(const char* entry, int value, int low, int high) {
    require(entry, static_cast<double>(value), low, high);
  }
  const Status& status() const { return status_; }

 private:
  // Appends the bound in decimal: up to 1e12, with up to six decimals. It does without the C library. It
  // works in doubles because small processors divide those in hardware, but 64-bit integers in a long
  // function.
  void append_bound(double bound) {
    constexpr double kPerOne = 1e6;
    if (bound < 0) status_.append("-");
    double rest = (bound < 0 ? -bound : bound) * kPerOne + 0.5;
    double power = kPerOne;
    while (power * 10 <= rest) power *= 10;
    for (; power >= kPerOne || rest >= 1; power /= 10) {
      if (power * 10 == kPerOne) status_.append(".");
      const int digit = static_cast<int>(rest / power);
      rest -= digit * power;
      status_.append(digit);
    }
  }

  const char* group_ = "";
  Status status_;
};

void check(RangeCheck& ranges, const DepthNoise& noise) {
  ranges.group("depth_noise.");
  ranges.require("c1", noise.c1, -1, 1);
  ranges.require("c2", noise.c2, -1, 1);
  ranges.require("c3", noise.c3, -1, 1);
  ranges.require("floor_m", noise.floor_m, 1e-6, 1.0);
  ranges.require("registration_px", noise.registration_px, 0, 20);
}

void check(RangeCheck& ranges, const PointConfig& points) {
  ranges.group("points.");
  ranges.require("sigma_px", points.sigma_px, 0.01, 20.0);
  ranges.require("depth_reach_px", points.depth_reach_px, 0, DepthSampler::kMaxRadius);
}

void check(RangeCheck& ranges, const NoiseConfig& noise) {
  ranges.group("noise.");
  ranges.require("learning_rate", noise.learning_rate, 0.0, 0.5);
  ranges.require("angular_rate_error_rad_per_s", noise.angular_rate_error_rad_per_s, 0, 10);
  ranges.require("shared_depth_m", noise.shared_depth_m, 0, 1);
  ranges.require("point_correlation", noise.point_correlation, 0, 1);
  ranges.require("line_correlation", noise.line_correlation, 0, 1);
  ranges.require("surface_correlation", noise.surface_correlation, 0, 1);
  ranges.require("common_mode_share", noise.common_mode_share, 0, 1);
}

void check(RangeCheck& ranges, const Line3dConfig& lines) {
  ranges.group("lines.");
  ranges.require("sample_spacing_px", lines.sample_spacing_px, 1, 1000);
  ranges.require("min_agreement", lines.min_agreement, 0, 1);
  ranges.require("sigma_p_px", lines.sigma_p_px, 0.01, 20.0);
  ranges.require("inlier_chi_square", lines.inlier_chi_square, 0.1, 100.0);
  ranges.require("side_reach_px", lines.side_reach_px, 0, kMaxSideReach);
  ranges.require("depth_correlation_px", lines.depth_correlation_px, 0.01, 1000.0);
  ranges.require("transverse_floor_px", lines.transverse_floor_px, 0, 20);
}

void check(RangeCheck& ranges, const MotionConfig& motion) {
  ranges.group("motion.");
  ranges.require("max_ransac_iterations", motion.max_ransac_iterations, 1, 100000);
  ranges.require("min_inliers", motion.min_inliers, 3, 10000);
  ranges.require("max_sigma_m", motion.max_sigma_m, 1e-6, 100.0);
  ranges.require("max_sigma_rad", motion.max_sigma_rad, 1e-6, 10.0);
}

void check(RangeCheck& ranges, const ReferenceConfig& references) {
  ranges.group("references.");
  ranges.require("keyframe_inlier_ratio", references.keyframe_inlier_ratio, 0, 1);
  ranges.require("max_lost_s", references.max_lost_s, 0, 1000000);
  ranges.require("process_noise_m_per_s", references.process_noise_m_per_s, 0, 100);
  ranges.require("process_noise_rad_per_s", references.process_noise_rad_per_s, 0, 100);
}

void check(RangeCheck& ranges, const BudgetConfig& budget) {
  ranges.group("budget.");
  ranges.require("frame_ns", static_cast<double>(budget.frame_ns), 0.0, 1e12);
  ranges.require("patience_frames", budget.patience_frames, 1, 1000000);
  ranges.require("spare_share", budget.spare_share, 0, 1);
}

}  // namespace

Status Limits::validate() const {
  RangeCheck ranges;
  ranges.group("Limits::");
  ranges.require("width", width, kLeastSide, kMostSide);
  ranges.require("height", height, kLeastSide, kMostSide);
  ranges.require("keypoints", keypoints, 10, 60000);
  ranges.require("segments", segments, 1, 60000);
  ranges.require("references", references, 1, kMaxReferences);
  ranges.require("line_bands", line_bands, 1, 8);
  ranges.require("kept_keyframes", kept_keyframes, 0,
                 std::min(kMostKeptKeyframes, kMostOtherFrames - references));
  ranges.require("cores", cores, 1, 2);
  ranges.require("surfaces", surfaces, 0, 1000);
  return ranges.status();
}

Status Config::validate() const {
  RangeCheck ranges;
  check(ranges, depth_noise);
  check(ranges, points);
  check(ranges, lines);
  check(ranges, noise);
  check(ranges, references);
  check(ranges, budget);
  check(ranges, motion);
  return ranges.status();
}

Config Config::paper() {
  Config config;
  config.surfaces = false;
  config.references.policy = ReferencePolicy::kPreviousFrame;
  config.depth_noise.registration_px = 0;
  config.noise = {.learning_rate = 0,
                  .angular_rate_error_rad_per_s = 0,
                  .shared_depth_m = 0,
                  .point_correlation = 0,
                  .line_correlation = 0,
                  .common_mode_share = 0};
  config.points.registered = false;
  config.points.sigma_px = 1;
  config.points.depth_reach_px = 0;
  config.lines = Line3dConfig::paper();
  config.motion.robust = false;
  return config;
}

Config Config::tiny() {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  return config;
}

}  // namespace plvo
