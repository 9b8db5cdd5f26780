// SPDX-License-Identifier: Apache-2.0
// Everything a user may set, with the defaults we recommend; Config::paper() gives the settings of Lu & Song
// (2015). Limits are capacities and decide the memory; Config only tunes what happens inside them.
#pragma once

#include <cstdint>

#include "plvo/base/executor.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/image/undistortion.hpp"
#include "plvo/lines/line3d.hpp"
#include "plvo/lines/line_match.hpp"
#include "plvo/motion/motion_config.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/points/detector.hpp"
#include "plvo/points/point_match.hpp"

namespace plvo {

// Capacities: fixed by init, never exceeded. What does not fit is dropped by a stated rule and counted.
struct Limits {
  // Images have at least and at most so many pixels a side.
  static constexpr int kLeastSide = 64;
  static constexpr int kMostSide = UndistortionMap::kMaxSide;

  int width = 640;      // px, largest image
  int height = 480;     // px
  int keypoints = 400;  // per frame
  int segments = 256;   // per frame
  // Frames that one is matched with, 1 … 3: a policy needs as many as it names. 1 saves a third of the
  // features' memory and half of the matches' that 2 take.
  int references = 2;
  // Bands of the image, one below the other, that segments are searched in, 1 … 8, each in the memory of the
  // one before. A segment that crosses from one into the next comes out as two.
  int line_bands = 1;
  // Keyframes that are kept after a loss, 0 … 4 (3 with 3 references), each as large as a reference
  // (kept_keyframes.hpp).
  int kept_keyframes = 1;
  // 2: points are searched for in scratch of their own, so that Config::executor may be set.
  int cores = 1;
  // Samples of surfaces per frame, 0 … 1000: what depth alone says of the motion. 0: none, and no memory.
  int surfaces = 200;
  static constexpr Limits vga() { return {}; }
  // A quarter of VGA's pixels and of its features: more of them make a frame better, but of a processor that
  // keeps up with no camera more frames make the motion better (docs/performance.md).
  static constexpr Limits qvga() { return {320, 240, 100, 64, 2, 1, 0, 1, 0}; }
  // Within 512 KiB, with Config::tiny().
  static constexpr Limits tiny() { return {320, 240, 200, 64, 1, 3, 0, 1, 0}; }
  // kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

enum class Features : std::uint8_t { kPoints, kLines, kBoth };

enum class ReferencePolicy : std::uint8_t {
  kPreviousFrame,  // the paper: every frame against the one before
  kKeyframe,       // against the last keyframe, replaced when too few of its features are still seen
  // Against the keyframe and a recent frame (ReferenceConfig::recent_frames) in one estimate: the keyframe
  // keeps the drift small, and most features of a recent frame are found again.
  kKeyframeAndPrevious,
  // Against these and the keyframe before: less drift where the camera walks, none where it turns fast, and
  // more time and memory (docs/sensors.md).
  kWindow,
};
constexpr int references_of(ReferencePolicy policy) {
  switch (policy) {
    case ReferencePolicy::kKeyframeAndPrevious: return 2;
    case ReferencePolicy::kWindow: return 3;
    default: return 1;
  }
}

struct PointConfig {
  DetectorConfig detector;
  PointMatchConfig match;
  // Keypoints are found again by registering their patches (alignment.hpp). false: by their descriptors
  // alone, as in the paper, each frame's keypoint being where its detector put it.
  bool registered = true;
  // σ_p on the finest level, doubling with each: what registration is never better than. Without registration
  // it is that of a detected keypoint.
  double sigma_px = 0.1;
  // Depth is that of a plane through the pixels so far around, 0 … 3; 0: of the pixel alone.
  int depth_reach_px = 2;
};

struct LineConfig {
  Line3dConfig fit;       // L2, L3
  LineMatchConfig match;  // L4, before the motion is known; afterwards these gates are enough:
  double guided_offset_px = 8;
  double guided_angle_rad = 0.1;
};

// How far the models of the noise are believed. How good the image and the depth are depends on the sensor,
// its exposure and the scene: no constants serve all.
struct NoiseConfig {
  // Where the scales start: plane residuals of real Kinects are half of σ_d (2), their square a quarter.
  NoiseScales initial{.image = 1, .depth = 0.25, .lines = 1, .surfaces = 0.25};
  // Each frame moves the scales by this share of what its residuals show; 0: they stay.
  double learning_rate = 0.1;
  // Where the errors start that all features of a frame share (nuisance_parameters.hpp), SD; 0: there are
  // none.
  double angular_rate_error_rad_per_s = 0.1;
  double shared_depth_m = 0.001;  // at 1 m
  // The correlation between the residuals of any two points, or lines, of a frame: what else they share
  // (reflections, the lens, the clock) does not average out either.
  double point_correlation = 0.1;
  double line_correlation = 0.02;
  double surface_correlation = 0.1;
  // How much of what matches with a keyframe err is the same in the next frame (common_mode_error.hpp).
  double common_mode_share = 0.6;
  // What the samples of surfaces in a depth image share, SD: when it was taken is off by so much, and its
  // depths by so much at 1 m, growing with their square.
  double depth_moment_s = 0.005;
  double depth_offset_m = 0.002;
};

struct ReferenceConfig {
  ReferencePolicy policy = ReferencePolicy::kKeyframeAndPrevious;
  // The recent frame is matched for at most so many frames, while half of its features are inliers; 1: it is
  // the last one, always. Points are looked for only in frames that will be matched, and where registration
  // fails.
  int recent_frames = 3;
  // A keyframe is kept while at least this share of its features are inliers.
  double keyframe_inlier_ratio = 0.3;
  // kWindow: it makes way sooner, and goes on being matched beside the next one while the second share is.
  double window_inlier_ratio = 0.35;
  double older_inlier_ratio = 0.2;
  // When tracking fails, features are looked for this far from where they were, whatever the prediction.
  double wide_search_px = 120;
  // After so many lost frames in a row the references are given up and tracking starts anew from the last
  // good pose, whose covariance then grows by the motion that nobody saw: at most this fast (SD per second).
  int max_lost_frames = 15;
  double process_noise_m_per_s = 0.5;
  double process_noise_rad_per_s = 0.5;
  // Once it tracks again, every so many frames it looks whether it is back at a kept keyframe.
  int relocalisation_interval_frames = 5;
};

// What a frame may take, where somebody waits for it (features/feature_budget.hpp). The caller measures.
struct BudgetConfig {
  std::int64_t frame_ns = 0;  // 0: as long as it takes, with all the features that Limits have room for
  // A step up again after so many frames in a row that took less than this share of it.
  int patience_frames = 30;
  double spare_share = 0.6;
};

// Called when a stage of a frame is over, several times a frame for matching and motion: where a watchdog is
// fed between stages. It may not call the odometry.
struct StageHook {
  void (*call)(void* context, Stage stage) = nullptr;
  void* context = nullptr;
};

struct Config {
  Features features = Features::kBoth;
  // Beside them samples of bare surfaces, where Limits have room for some (plvo/surfaces).
  bool surfaces = true;
  // A level world: its y axis points down, its heading is the first camera's. The first frame then waits for
  // one that brings gravity in its prior; what that says wrong of roll and pitch, later frames put right.
  // set_pose() before the first frame comes before it.
  bool level_world = false;
  ReferenceConfig references;
  DepthNoise depth_noise;
  NoiseConfig noise;
  PointConfig points;
  LineConfig lines;
  MotionConfig motion;
  BudgetConfig budget;
  // Of the random generators of RANSAC: over matches, and over the depths along each line.
  std::uint64_t seed = 1;

  // For per-stage times: a monotonic clock in nanoseconds. The core reads no other clock, and never decides
  // by it.
  std::int64_t (*stage_clock)() = nullptr;
  StageHook stage_hook;
  // Where there is a second core: it takes half of the images' rows and of the features, and the points while
  // segments are searched for (Stage::kPoints is then the time of both searches). Needs Limits::cores = 2.
  Executor executor;

  static Config paper();
  // Settings that Limits::tiny() has the room for.
  static Config tiny();
  // kInvalidArgument, naming the entry and its range; kUnsupported for features that are not built
  // (PLVO_FEATURES).
  Status validate() const;
};

}  // namespace plvo
