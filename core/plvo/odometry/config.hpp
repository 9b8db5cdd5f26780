// SPDX-License-Identifier: Apache-2.0
// Everything a user may set, with the defaults we recommend; Config::paper() gives the settings of Lu & Song
// (2015). Limits are capacities and decide the memory; Config only tunes what happens inside them.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/lines/line3d.hpp"
#include "plvo/lines/line_match.hpp"

namespace plvo {

// Capacities: fixed by init, never exceeded. What does not fit is dropped by a stated rule and counted.
struct Limits {
  int width = 640;       // px, largest image
  int height = 480;      // px
  int keypoints = 1000;  // per frame
  int segments = 256;    // per frame
  static constexpr Limits vga() { return {}; }
  static constexpr Limits qvga() { return {320, 240, 500, 128}; }
  // kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

enum class Features : std::uint8_t { kPoints, kLines, kBoth };

enum class ReferencePolicy : std::uint8_t {
  kPreviousFrame,  // the paper: every frame against the one before
  kKeyframe,       // against the last keyframe, replaced when too few of its features are still seen
};

struct PointConfig {
  // σ_p on the finest level, doubling with each; where a keypoint was found again by registration, its
  // uncertainty there is added in quadrature. Wider than one keypoint alone deserves: those of a scene err
  // together.
  double sigma_px = 1.0;
  int pyramid_levels = 3;   // searched for keypoints, 1 … 4
  int cell_px = 40;         // keypoints are spread over cells of this side, 24 … 64
  int noise_floor = 5;      // grey levels: contrast below this is the sensor's noise, 1 … 64
  double min_strength = 8;  // least corner strength, (grey levels / px)²
  double search_radius_px =
      30;                   // around the predicted position; a second search, when the first fails, is wider
  int max_distance = 64;    // Hamming, of 256 bits
  double max_ratio = 0.85;  // best distance / second best
};

struct LineConfig {
  Line3dConfig fit;       // L2, L3
  LineMatchConfig match;  // L4, before the motion is known; afterwards these gates are enough:
  double guided_offset_px = 8;
  double guided_angle_rad = 0.1;
};

struct MotionConfig {
  double inlier_probability = 0.99;  // of the chi-square test that decides inliers, points and lines alike
  int max_ransac_iterations = 300;
  int min_inliers = 10;
  bool robust = true;  // down-weight large residuals in the maximum-likelihood refinement

  // A keyframe is kept while at least this share of its keypoints are inliers.
  double keyframe_inlier_ratio = 0.5;

  // When tracking fails, features are looked for this far from where they were, whatever the prediction.
  double wide_search_px = 120;
  // After so many lost frames in a row the reference is given up and tracking starts anew from the last good
  // pose, whose covariance then grows by the motion that nobody saw: at most this fast (SD per second).
  int max_lost_frames = 15;
  double unseen_m_per_s = 0.5;
  double unseen_rad_per_s = 0.5;
};

struct Config {
  Features features = Features::kBoth;
  ReferencePolicy reference = ReferencePolicy::kPreviousFrame;
  DepthNoise depth_noise;
  PointConfig points;
  LineConfig lines;
  MotionConfig motion;
  std::uint64_t seed = 1;  // of RANSAC's random generator

  // For per-stage times: a monotonic clock in nanoseconds. The core reads no other clock, and never decides
  // by it.
  std::int64_t (*stage_clock)() = nullptr;

  static Config paper();
  // kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
