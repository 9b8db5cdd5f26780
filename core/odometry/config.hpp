// SPDX-License-Identifier: Apache-2.0
// Everything a user may set, with the defaults we recommend; Config::paper() gives the settings of Lu & Song
// (2015). Limits are capacities and decide the memory; Config only tunes what happens inside them.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/camera/depth_noise.hpp"

namespace plvo {

// Capacities: fixed by init, never exceeded. What does not fit is dropped by a stated rule and counted.
struct Limits {
  int width = 640;       // px, largest image
  int height = 480;      // px
  int keypoints = 1000;  // per frame
  int segments = 256;    // per frame
  static constexpr Limits vga() { return {}; }
  static constexpr Limits qvga() { return {320, 240, 500, 128}; }
};

enum class Features : std::uint8_t { kPoints, kLines, kBoth };

enum class ReferencePolicy : std::uint8_t {
  kPreviousFrame,  // the paper: every frame against the one before
  kKeyframe,       // against the last keyframe, replaced when too few of its features are still seen
};

struct PointConfig {
  double sigma_px = 0.35;        // σ_p on the finest pyramid level, after sub-pixel refinement
  int pyramid_levels = 3;        // 1 … 4
  int cell_px = 40;              // keypoints compete within a cell and are spread over the cells
  double min_contrast = 6.0;     // least corner strength that is above the sensor's noise, grey levels
  int max_hamming = 60;          // of 256 bits
  double search_radius_px = 60;  // around the predicted position, when nothing better is known
};

struct LineConfig {
  double sigma_px = 0.5;  // transverse σ of a sample on a segment
  double min_length_px = 20;
  double min_consensus = 0.6;  // τ of the paper
};

struct MotionConfig {
  double inlier_probability = 0.99;  // of the chi-square test that decides inliers, points and lines alike
  int max_ransac_iterations = 300;
  int min_inliers = 10;
  bool robust = true;  // down-weight large residuals in the maximum-likelihood refinement
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
