// SPDX-License-Identifier: Apache-2.0
// The public API: frames in, poses with covariances out. After Lu & Song, "Robust RGB-D Odometry Using Point
// and Line Features" (ICCV 2015), Figure 1.
//
//   alignas(plvo::kArenaAlignment) static std::byte memory[plvo::required_bytes(plvo::Limits::vga())];
//   plvo::Odometry odometry;
//   plvo::Status status = odometry.init(memory, camera, plvo::Config{}, plvo::Limits::vga());
//   plvo::TrackResult result = odometry.track(frame);  // or track(frame, imu), or track(frame, prior)
//
// Memory: init divides the caller's block once; nothing is allocated or freed afterwards. Threads: one thread
// at a time may use an Odometry. Determinism: the same frames and config give the same bits on every
// supported machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/decision.hpp"
#include "plvo/odometry/disagreement.hpp"
#include "plvo/odometry/feature_views.hpp"
#include "plvo/odometry/features/feature_budget.hpp"
#include "plvo/odometry/features/feature_extraction.hpp"
#include "plvo/odometry/gravity_filter.hpp"
#include "plvo/odometry/image_streams.hpp"
#include "plvo/odometry/parallax_check.hpp"
#include "plvo/odometry/prediction.hpp"
#include "plvo/odometry/propagated_prior.hpp"
#include "plvo/odometry/recovery.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/odometry/tracking/current_frame.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/odometry/window/window.hpp"
#include "plvo/points/carried_cells.hpp"

namespace plvo {

// What init allocates after the window's frames, in order; an arena without memory counts the bytes.
struct OdometryMemory {
  FeatureViews views;
  FeatureExtraction extraction;
  ReferenceTracking tracking;

  constexpr void allocate(Arena& memory, const Limits& limits) {
    views.allocate(memory, limits);
    extraction.allocate(memory, limits);
    tracking.allocate(memory, limits);
  }
  // The stages of a frame run one after the other, so the largest scratch counts.
  static constexpr void reserve(Arena& memory, const Limits& limits) {
    FeatureExtraction::reserve(memory, limits);
    ReferenceTracking::reserve(memory, limits);
  }
};

// Bytes that init needs for these capacities, whatever the alignment of the block.
constexpr std::size_t required_bytes(const Limits& limits) {
  Arena sizer = Arena::counting();
  Window::Features features;
  OdometryMemory memory;
  Window::allocate(sizer, limits, features);
  memory.allocate(sizer, limits);
  OdometryMemory::reserve(sizer, limits);
  return sizer.peak() + kArenaAlignment;
}

// The keyframe that frames are matched with, and its pose as known now.
struct KeyframeView {
  const FrameFeatures* features = nullptr;  // null: there is none
  Se3 T_world_camera;
  // Velocity (v, ω) of the scene during its exposure, per second (exposure.hpp), as known now; zero if it is
  // not known.
  Vector6 velocity = Vector6::Zero();
};

class Odometry {
 public:
  Odometry();
  // Checks all arguments, allocates from `memory` and builds the tables. The message of kOutOfMemory states
  // how many bytes are needed.
  Status init(std::span<std::byte> memory, const CameraModel& camera, const Config& config = {},
              const Limits& limits = Limits::vga());

  // Never fails: the state and the status of the result report all errors. A frame of the wrong size, with
  // null views, or not later than the one before is refused (kLost, kInvalidArgument). It does not change the
  // state of the tracking; features() then shows no segments and no tracks.
  // After a loss so long that the position may be anywhere (covariance.hpp), the first usable frame starts a
  // new world, like the very first frame: kInitialising, and TrackResult::world has risen. The pose of
  // set_pose() is forgotten with the old world.
  TrackResult track(const RgbdFrame& input);
  // Tracks with measurements of other sensors. Their motion guides the search for features and joins the
  // estimate as one more constraint. Directions that vision leaves open then have a large covariance but
  // cause no loss. A frame without usable features is kPredicted if every frame since the last good one came
  // with a rotation or a translation. Gravity corrects roll and pitch of the pose. An empty prior
  // has no effect. If a prior does not pass MotionPrior::validate(), it is refused together with
  // its frame.
  TrackResult track(const RgbdFrame& input, const MotionPrior& prior);
  // Tracks with the samples of a gyro and an accelerometer that wait in `imu`, and corrects the gyro's offset
  // by the estimated rotation. Every frame must be tracked by this function: `imu` must give the samples of
  // all intervals. A refused frame uses up no samples. wheels: the motion that wheels measured. Its
  // rotation is used only if the gyro measured none. Its gravity is never used.
  TrackResult track(const RgbdFrame& input, ImuIntegrator& imu, const MotionPrior& wheels = MotionPrior());

  // Restores the state after init: the next usable frame defines a world of the next number, and the learnt
  // noise is forgotten. The time budget stays, because it depends on the machine.
  void reset();
  // Sets the pose of the last frame that has one, in a world of the caller's, with the covariance of its
  // ⊞-perturbation. Before the first frame it sets the pose of the first usable one. The direction of gravity
  // is learnt anew. Variances beyond the bound of covariance.hpp are set to the bound. Returns
  // kInvalidArgument, and changes nothing: before init, for a matrix that is not a rotation (to 1e-6), a
  // position beyond 1e8 m, a matrix that is no covariance (is_covariance()), or numbers that are not finite.
  Status set_pose(const Se3& T_world_camera, const Matrix6& covariance);

  // For Config::budget: the duration of the last call of track(), by the caller's clock. The number of
  // features of the next frames depends on nothing else.
  void frame_took(std::int64_t ns) { budget_.note(ns); }

  // What init allocated, by owner; size-optimised code does not record it.
  std::span<const Arena::Record> memory_records() const;
  // Bytes that init allocated.
  std::size_t memory_used() const;
  // Most bytes that were in use at any time, with the scratch of the stages.
  std::size_t memory_peak() const;

  // Both are valid until the next call of track().
  FeatureView features() const;
  KeyframeView keyframe() const;

 private:
  // The steps of a frame, in their order. No step before update() changes a pose, a reference or
  // the world.
  Status check(const RgbdFrame& input, const MotionPrior& prior) const;
  TrackResult process(const RgbdFrame& input, const MotionPrior& prior);
  PropagatedPrior propagate(std::int64_t stamp_ns, const MotionPrior& prior) const;
  bool wants_points() const;
  void search(const CurrentFrame& frame, TrackedMotion& tracked);
  TrackResult conclude(const CurrentFrame& frame, const TrackedMotion& tracked);
  Decision decide(const CurrentFrame& frame, const TrackedMotion& tracked) const;
  TrackResult update(const CurrentFrame& frame, const Decision& decision, const TrackedMotion& tracked);
  void accept(const CurrentFrame& frame, const Decision& decision, const TrackedMotion& tracked,
              TrackResult& result);
  void start(const CurrentFrame& frame, const Decision& decision, TrackResult& result);
  void lose(const CurrentFrame& frame, const Decision& decision, TrackResult& result);
  void note_pose(TrackResult& result);
  void relocalise(const CurrentFrame& frame, TrackedMotion& tracked, TrackResult& result);
  // For frames whose motion is not searched: a refused one, and one that repeats an image.
  // forget_world() discards all poses.
  TrackResult refuse(const RgbdFrame& input, const Status& refusal) const;
  TrackResult pass_over(const RgbdFrame& input, const MotionPrior& prior);
  void forget_world();

  Arena arena_;
  CameraModel camera_;
  // Empty until init: the code that constructs a Config stays in the user's program
  std::optional<Config> config_;
  OdometryMemory memory_;
  FeatureBudget budget_;

  Window window_;
  RelocalisationTurn relocalisation_;
  PropagatedPrior propagated_prior_;  // since the last good frame
  GravityFilter gravity_;
  NoiseScales noise_;                          // learnt so far
  Disagreement disagreement_;                  // of late
  ParallaxCheck parallax_;                     // of late
  std::optional<std::int64_t> last_stamp_ns_;  // of the last frame that was processed, good or not
  std::optional<std::int64_t> lost_since_ns_;  // stamp of the first lost frame since a pose from images
  bool start_is_set_ = false;                  // by set_pose()
  bool world_is_lost_ = false;                 // and the next one has not started
  std::uint32_t world_ = 0;                    // TrackResult::world
  ColourStream colour_;
  DepthStream depth_;
  CarriedCells carried_;
  FeatureCounts points_found_;  // of the latest frame in which points were searched
  int view_slot_ = 0;           // whose keypoints features() shows
};

}  // namespace plvo
