// SPDX-License-Identifier: Apache-2.0
// Everything a user may set, with the recommended defaults. Config::paper() gives the settings of Lu & Song
// (2015). Limits are capacities and determine the memory; Config only tunes what happens within them. A
// number that neither the paper, a small board nor another sensor needs to change stands beside the algorithm
// that uses it.
#pragma once

#include <cstdint>

#include "plvo/base/executor.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/depth_noise.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/undistortion.hpp"
#include "plvo/lines/line3d.hpp"
#include "plvo/motion/motion_config.hpp"
#include "plvo/odometry/stage.hpp"

namespace plvo {

// Capacities: fixed by init, never exceeded. What does not fit is dropped by a stated rule and counted.
struct Limits {
  // Bounds on the width and on the height of an image, in pixels.
  static constexpr int kLeastSide = 64;
  static constexpr int kMostSide = UndistortionMap::kMaxSide;

  int width = 640;      // px, largest image
  int height = 480;     // px
  int keypoints = 400;  // per frame
  int segments = 256;   // per frame
  // Number of frames that the current one is matched with, 1 … 3; the policy sets the minimum
  // (references_of). With 1 instead of 2, features take a third less memory and matches take half.
  int references = 2;
  // Horizontal bands of the image in which segments are searched one after the other, 1 … 8. All bands use
  // the same memory: with a single band tiny() would not fit within 512 KiB. A segment that crosses a border
  // between bands is found as two.
  int line_bands = 1;
  // Number of keyframes kept after a loss, 0 … 4 (3 with 3 references). Each is as large as a reference
  // (kept_keyframes.hpp).
  int kept_keyframes = 1;
  // 2: the search for points has its own scratch, so that Config::executor may be set.
  int cores = 1;
  // Surface samples per frame, 0 … 1000; they constrain the motion by depth alone. 0: none, and no memory for
  // them.
  int surfaces = 200;
  // Whether Config::mask may be set. It takes width × height × 33/16 bytes more, mostly for a depth image
  // without the masked readings.
  bool mask = false;
  static constexpr Limits vga() { return {}; }
  // A quarter of VGA's pixels and features. With more features the estimate of a frame is better. But on a
  // processor that cannot keep up with the camera, a higher frame rate improves the motion more
  // (docs/decisions/qvga_capacities.md).
  static constexpr Limits qvga() {
    return {
        .width = 320, .height = 240, .keypoints = 100, .segments = 64, .kept_keyframes = 0, .surfaces = 0};
  }
  // Fits within 512 KiB, with Config::tiny().
  static constexpr Limits tiny() {
    return {.width = 320,
            .height = 240,
            .keypoints = 200,
            .segments = 64,
            .references = 1,
            .line_bands = 3,
            .kept_keyframes = 0,
            .surfaces = 0};
  }
  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

enum class Features : std::uint8_t { kPoints, kLines, kBoth };

enum class ReferencePolicy : std::uint8_t {
  kPreviousFrame,  // the paper: matches every frame with the one before
  kKeyframe,       // matches with the last keyframe, which is replaced when too few of its features are still
                   // seen
  // Matches with the keyframe and a recent frame (Window::kRecentFrames) in one estimate. The
  // keyframe keeps the drift small; the recent frame shares most features with the current one.
  kKeyframeAndPrevious,
  // Matches with these and the previous keyframe. The drift is smaller where the camera moves on, but not
  // where it rotates fast; time and memory grow (docs/decisions/window.md).
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
  // true: keypoints are found again by registering their patches (alignment.hpp). false: by their descriptors
  // alone, as in the paper; a keypoint of a frame then lies where the detector put it.
  bool registered = true;
  // σ_p on the finest level; it doubles with each level. With registration it is a lower bound on the error;
  // without, it is the error of a detected keypoint.
  double sigma_px = 0.1;
  // Depth comes from a plane through the pixels within this radius, 0 … 3; 0: from the pixel alone.
  int depth_reach_px = 2;
};

// Scales of the noise models, and how they are learnt. The quality of image and depth depends on the sensor,
// its exposure and the scene, so no constants suit all.
struct NoiseConfig {
  // Each frame moves the scales by this share towards what its residuals show; 0: the models stay as they
  // are, and the covariance does not grow where kinds of measurements contradict each other
  // (disagreement.hpp, PoseWithCovariance::shifts).
  double learning_rate = 0.1;
  // Initial SDs of the nuisance parameters that all features of a frame share (nuisance_parameters.hpp); 0:
  // there are none.
  double angular_rate_error_rad_per_s = 0.1;
  double shared_depth_m = 0.001;  // at 1 m
  // Correlation between the residuals of any two points, or lines, of a frame. It models other common errors
  // (reflections, the lens, the clock), which do not average out either.
  double point_correlation = 0.1;
  double line_correlation = 0.02;
  double surface_correlation = 0.1;
  // Share of the error of matches with a keyframe that is the same in the next frame (common_mode_error.hpp).
  double common_mode_share = 0.6;
};

struct ReferenceConfig {
  ReferencePolicy policy = ReferencePolicy::kKeyframeAndPrevious;
  // A keyframe is kept while at least this share of its features are inliers.
  double keyframe_inlier_ratio = 0.3;
  // When every frame has been lost for this long, the odometry gives up the references and starts anew from
  // the last good pose. The covariance of that pose then grows by the process noise below (SD per second),
  // and by the motion of a camera that kept its velocity. Where Limits have memory for a kept keyframe, a
  // lost frame is also matched with the lost frame before, and tracking restarts as soon as they agree.
  double max_lost_s = 0.5;
  double process_noise_m_per_s = 0.5;
  double process_noise_rad_per_s = 0.5;
};

// Time budget of a frame in real-time use (features/feature_budget.hpp). The caller measures the time.
struct BudgetConfig {
  std::int64_t frame_ns = 0;  // 0: no limit; a frame has all the features that Limits allow
  // The number of features rises by one step after this many frames in a row that took less than this share
  // of the budget.
  int patience_frames = 30;
  double spare_share = 0.6;
};

// Called at the end of each stage of a frame; for matching and motion, several times a frame. A watchdog can
// be fed here. The hook must not call the odometry.
struct StageHook {
  void (*call)(void* context, Stage stage) = nullptr;
  void* context = nullptr;
};

struct Config {
  Features features = Features::kBoth;
  // Adds samples of bare surfaces, where Limits allow some (plvo/surfaces).
  bool surfaces = true;
  // true: the world is level. Its y axis points down and its heading is that of the first camera. Tracking
  // then starts at the first frame whose prior has gravity; later frames correct errors of that reading in
  // roll and pitch. A set_pose() before the first frame takes precedence.
  bool level_world = false;
  ReferenceConfig references;
  DepthNoise depth_noise;
  NoiseConfig noise;
  PointConfig points;
  Line3dConfig lines;  // L2, L3
  MotionConfig motion;
  BudgetConfig budget;
  // Pixels that show what travels with the camera (a part of the robot, burnt-in text): 0 where the image
  // must not be used, any other value where it is. The mask has the size of the camera's images and is in
  // their pixels, before undistortion. What lies in masked pixels, grey levels and depth, has no influence on
  // the result (image/image_mask.hpp). The pixels are borrowed: they must stay valid and unchanged as long as
  // the odometry is used. No data: all pixels are used. Needs Limits::mask.
  GrayView mask;
  // Seed of the random generators of RANSAC: over matches, and over the depths along each line.
  std::uint64_t seed = 1;

  // A monotonic clock in nanoseconds, for the times of the stages. The core reads no other clock, and its
  // decisions do not depend on it.
  std::int64_t (*stage_clock)() = nullptr;
  StageHook stage_hook;
  // Runs work on a second core: half of the images' rows and of the features, and the points while segments
  // are searched (Stage::kPoints is then the time of both searches). Needs Limits::cores = 2.
  Executor executor;

  static Config paper();
  // Settings that fit into Limits::tiny().
  static Config tiny();
  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

}  // namespace plvo
