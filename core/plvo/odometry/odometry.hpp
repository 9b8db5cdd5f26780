// SPDX-License-Identifier: Apache-2.0
// The public API: frames in, poses with covariances out. After Lu & Song, "Robust RGB-D Odometry Using Point
// and Line Features" (ICCV 2015), Figure 1.
//
//   alignas(plvo::kArenaAlignment) static std::byte memory[plvo::required_bytes(plvo::Limits::vga())];
//   plvo::Odometry odometry;
//   plvo::Status status = odometry.init(memory, camera, plvo::Config{}, plvo::Limits::vga());
//   plvo::TrackResult result = odometry.track(frame);  // or track(frame, prior), with a gyro's help
//
// Memory: init divides the caller's block once; nothing is allocated or freed afterwards. Threads: one thread
// at a time may use an Odometry. Determinism: the same frames and config give the same bits on every
// supported machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/base/status.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/features/feature_budget.hpp"
#include "plvo/odometry/features/feature_extraction.hpp"
#include "plvo/odometry/features/frame_features.hpp"
#include "plvo/odometry/gravity_filter.hpp"
#include "plvo/odometry/propagated_prior.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "plvo/odometry/window.hpp"

namespace plvo {

// The features of the last frame, for drawing: pixels of the undistorted image. Valid until the next call of
// track(). A track pairs a position in the reference with the position in this frame where it was found.
struct PointTrackView {
  float u_reference = 0, v_reference = 0, u = 0, v = 0;  // px
  bool inlier = false;
};
struct LineTrackView {
  std::uint16_t reference = 0, current = 0;  // indices into reference_segments and segments
  bool inlier = false;
};
struct SegmentView {
  float a_u = 0, a_v = 0, b_u = 0, b_v = 0;  // px
  bool has_3d = false;
};
struct FeatureView {
  GrayView image;                       // undistorted, grey
  std::span<const Keypoint> keypoints;  // empty if none were searched (recent_frames)
  std::span<const SegmentView> segments, reference_segments;
  std::span<const PointTrackView> point_tracks;
  std::span<const LineTrackView> line_tracks;
};

// What init allocates, in order; an arena without memory counts the bytes.
struct OdometryMemory {
  FeatureExtraction extraction;
  ReferenceTracking tracking;
  std::span<PointTrackView> point_track_views;
  std::span<LineTrackView> line_track_views;
  std::span<SegmentView> segment_views, reference_segment_views;

  constexpr void allocate(Arena& memory, const Limits& limits) {
    point_track_views =
        memory.take<PointTrackView>("feature view", static_cast<std::size_t>(limits.keypoints));
    const auto segments = static_cast<std::size_t>(limits.segments);
    line_track_views = memory.take<LineTrackView>("feature view", segments);
    segment_views = memory.take<SegmentView>("feature view", segments);
    reference_segment_views = memory.take<SegmentView>("feature view", segments);
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

class Odometry {
 public:
  Odometry();
  // Checks all arguments, allocates from `memory` and builds the tables. The message of kOutOfMemory states
  // how many bytes are needed.
  Status init(std::span<std::byte> memory, const CameraModel& camera, const Config& config = {},
              const Limits& limits = Limits::vga());

  // Never fails: the state and the status of the result report all errors. A frame of the wrong size, with
  // null views, or not later than the one before is refused (kLost, kInvalidArgument) and changes nothing.
  // After a loss so long that the position may be anywhere (covariance.hpp), the first usable frame starts a
  // new world, like the very first frame: kInitialising, and the status is ok() with a message. The pose of
  // set_pose() is forgotten with the old world.
  TrackResult track(const RgbdFrame& input);
  // Tracks with measurements of other sensors. Their motion guides the search for features and joins the
  // estimate as one more constraint. Directions that vision leaves open then have a large covariance but
  // cause no loss, and a frame without usable features is kPredicted. Gravity corrects roll and pitch of the
  // pose. An empty prior changes nothing; one that does not pass MotionPrior::validate() is refused with the
  // frame.
  TrackResult track(const RgbdFrame& input, const MotionPrior& prior);

  // Restores the state after init: the next usable frame defines the world, and the learnt noise is
  // forgotten. The time budget stays, because it depends on the machine.
  void reset();
  // Sets the pose of the last frame that has one, in a world of the caller's, with the covariance of its
  // ⊞-perturbation; before the first frame, that of the first usable one. The direction of gravity is learnt
  // anew. Variances beyond the bound of covariance.hpp are set to the bound. Returns kInvalidArgument, and
  // changes nothing: before init, for a matrix that is not a rotation (to 1e-6), a position beyond 1e8 m, a
  // covariance that is not symmetric or has a negative eigenvalue, or numbers that are not finite.
  Status set_pose(const Se3& T_world_camera, const Matrix6& covariance);

  // For Config::budget: the duration of the last call of track(), by the caller's clock. The number of
  // features of the next frames depends on nothing else.
  void frame_took(std::int64_t ns) { budget_.note(ns); }

  // Allocations in the block by owner (size-optimised code does not record them), and the high-water mark of
  // the scratch behind it.
  std::span<const Arena::Record> memory_records() const;
  std::size_t memory_used() const;
  std::size_t memory_peak() const;

  FeatureView features() const;

 private:
  using References = std::array<Reference, kMaxReferences>;

  // odometry.cpp: checks of the input, and the processing of a frame.
  Status check(const RgbdFrame& input) const;
  void process(const RgbdFrame& input, const MotionPrior& prior, TrackResult& result);
  bool wants_points() const;
  void find_points(const DepthSampler& depth, TrackResult& result);
  void describe_points(TrackResult& result);
  double depth_after_colour_s(const RgbdFrame& input) const;

  // odometry_motion.cpp: where the camera is expected, and the search for the motion from there.
  Exposure predict_exposure(std::int64_t stamp_ns) const;
  Se3 predict_motion(int reference, std::int64_t stamp_ns) const;
  PairPrior prior_of(int reference, std::int64_t stamp_ns) const;
  std::size_t list_references(std::int64_t stamp_ns, References& references) const;
  // Whether there is a recent frame that may be matched once more.
  bool recent_is_young() const {
    return window_.has_recent() && window_.recent_age() + 1 < config().references.recent_frames;
  }
  void estimate_motion(const DepthSampler& depth, TrackedMotion& tracked, TrackResult& result);

  // odometry_outcome.cpp: the outcome of a frame, and which frames the next ones are matched with.
  void start_first(const MotionPrior& prior, TrackResult& result);
  void start_again(const MotionPrior& prior, TrackResult& result);
  void start_at(const PoseWithCovariance& pose, TrackResult& result);
  void forget_world();
  void read_gravity(const MotionPrior& prior, PoseWithCovariance& pose);
  void add_process_noise(std::int64_t stamp_ns, Matrix6& covariance) const;
  void accept(const DepthSampler& depth, const TrackedMotion& tracked, const MotionPrior& prior,
              TrackResult& result);
  Window::Kept still_good() const;
  void keep_image();
  bool still_seen(int slot, std::size_t reference, double share) const;
  bool affordable(int slot) const;
  void lose(const MotionEstimate& motion, const MotionPrior& prior, TrackResult& result);
  const char* first_word_of_loss() const;

  // odometry_pose.cpp: poses of the kept frames, and poses from other sensors alone.
  void report(const PoseWithCovariance& pose, const Vector6& velocity, TrackResult& result) const;
  void sense(const MotionPrior& prior, std::int64_t stamp_ns);
  PoseWithCovariance predicted_pose(const MotionPrior& prior, TrackResult& result) const;

  // recovery.cpp: relocalisation when the view of a kept keyframe comes back.
  bool recognise(int slot, FrameFeatures& features, const Vector6& velocity, const DepthSampler& depth,
                 const PoseWithCovariance& believed, TrackedMotion& tracked, TrackResult& result);
  bool resume(const DepthSampler& depth, const MotionPrior& prior, TrackedMotion& tracked,
              TrackResult& result);
  bool relocalisation_is_due() const {
    return !window_.kept().empty() &&
           frames_since_relocalisation_ + 1 >= config().references.relocalisation_interval_frames;
  }
  void relocalise(const DepthSampler& depth, TrackedMotion& tracked, TrackResult& result);
  void move_to_relocalised_pose(int slot, const MotionEstimate& motion);

  // odometry_views.cpp: what features() shows.
  static std::size_t fill_segment_views(const LineFeatures& lines, std::span<SegmentView> views);
  void fill_track_views(const MotionEstimate& motion);

  const CameraModel& camera() const { return memory_.extraction.camera(); }
  const Config& config() const { return memory_.extraction.config(); }

  Arena arena_;
  OdometryMemory memory_;
  FeatureBudget budget_;
  bool ready_ = false;

  Window window_;
  int frames_since_relocalisation_ = 0;
  PropagatedPrior propagated_prior_;  // since the last good frame
  GravityFilter gravity_;
  NoiseScales noise_;                // learnt so far
  double depth_after_colour_s_ = 0;  // of the current frame
  std::int64_t last_stamp_ns_ = 0;   // of the last frame that was processed, good or not
  bool has_stamp_ = false;
  bool start_is_set_ = false;   // by set_pose()
  bool world_is_lost_ = false;  // and the next one has not started
  int lost_frames_ = 0;
  FeatureCounts points_found_;  // of the latest frame in which points were searched
  int view_slot_ = 0;           // whose keypoints features() shows
  std::size_t point_track_count_ = 0;
  std::size_t line_track_count_ = 0;
  std::size_t segment_count_ = 0;
  std::size_t reference_segment_count_ = 0;
};

}  // namespace plvo
