// SPDX-License-Identifier: Apache-2.0
// Figure 1, boxes P4, L4, 5 and 6: the motion from the references to the current frame. A first motion, from
// one reference, comes from align(), by the images, or if that fails from find(), by descriptors. Then
// refine() registers the features of all references with it and solves for one motion over all of them. Both
// find() and refine() associate features and estimate a motion from them; motion_search.hpp calls them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/motion/motion_estimator.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/odometry/tracking/current_frame.hpp"
#include "plvo/odometry/tracking/line_tracking.hpp"
#include "plvo/odometry/tracking/noise_learning.hpp"
#include "plvo/odometry/tracking/point_tracking.hpp"
#include "plvo/odometry/tracking/row_time_compensation.hpp"
#include "plvo/odometry/tracking/surface_tracking.hpp"
#include "plvo/points/sparse_alignment.hpp"

namespace plvo {

// Index of the reference with the latest stamp.
std::size_t latest_of(std::span<const Reference> references);

// Tracks of one reference in the current frame.
struct ReferenceTracks {
  PointTracks points;
  std::span<std::uint8_t> point_inliers;  // one flag per element of points.matches
  FixedVector<Match> lines;               // indices of both frames' 3D lines
  std::span<std::uint8_t> line_inliers;
  FixedVector<SurfaceMatch> surfaces;
  int inliers = 0;  // points and lines

  constexpr void allocate(Arena& memory, const Limits& limits) {
    allocate_measurements(memory, limits);
    allocate_matches(memory, limits);
  }
  // What only an estimate reads.
  constexpr void allocate_measurements(Arena& memory, const Limits& limits) {
    points.points = memory.take<Point3d>("point tracks", static_cast<std::size_t>(limits.keypoints));
    if (limits.surfaces > 0)
      surfaces = FixedVector<SurfaceMatch>(
          memory.take<SurfaceMatch>("surface tracks", static_cast<std::size_t>(limits.surfaces)));
  }
  // The rest, which is also read when the motion is known.
  constexpr void allocate_matches(Arena& memory, const Limits& limits) {
    const auto keypoints = static_cast<std::size_t>(limits.keypoints);
    points.matches = FixedVector<Match>(memory.take<Match>("point tracks", keypoints));
    points.pixels = memory.take<Vector2>("point tracks", keypoints);
    point_inliers = memory.take<std::uint8_t>("point tracks", keypoints);
    const auto segments = static_cast<std::size_t>(limits.segments);
    lines = FixedVector<Match>(memory.take<Match>("line tracks", segments));
    line_inliers = memory.take<std::uint8_t>("line tracks", segments);
  }
};

struct MatchCounts {
  int matched = 0;
  int inliers = 0;
};

// The frame from which a motion was estimated.
struct MotionBase {
  enum class Kind : std::uint8_t {
    kReferences,  // the keyframe, beside the other references
    kLost,        // the lost frame before
    kKept,        // a keyframe from before a loss
  };
  Kind kind = Kind::kReferences;
  int slot = -1;  // in the window
};

struct TrackedMotion {
  MotionEstimate motion;  // from the base
  MotionBase base;
  bool gives_up = false;   // the references are out of view for too long
  Exposure exposure;       // motion of the camera during the exposure of the current frame
  NoiseScales observed;    // observed scales of the noise
  DepthShift depth_shift;  // from the motion by parallax; by the matches with the base
  MatchCounts points, lines;
  int ransac_iterations = 0, lm_iterations = 0;  // of all estimates that were tried

  bool ok() const { return motion.status == StatusCode::kOk; }
  int inliers() const { return points.inliers + lines.inliers; }
};

// Bytes of an estimate and of its tracks, kept while other motions are tried.
struct KeptEstimate {
  std::byte tracked[sizeof(TrackedMotion)];
  std::byte tracks[kMaxReferences * sizeof(ReferenceTracks)];
  std::span<std::byte> matches;  // ReferenceTracks::allocate_matches
};

class ReferenceTracking {
 public:
  constexpr void allocate(Arena& memory, const Limits& limits) {
    for (std::size_t r = 0; r < static_cast<std::size_t>(limits.references); ++r)
      tracks_[r].allocate_measurements(memory, limits);
    const std::size_t mark = memory.mark();
    allocate_matches(memory, limits);
    matches_ = memory.since(mark);
    alignment_.allocate(memory, limits.width, limits.height);
  }
  // Reserves the scratch of the largest stage; the stages run one after the other.
  static constexpr void reserve(Arena& memory, const Limits& limits) {
    const ScratchScope scope(memory);
    memory.take<KeptEstimate>("kept estimate", 1);
    ReferenceTracking().allocate_matches(memory, limits);
    {
      const ScratchScope aligning(memory);
      SparseAlignment::take_windows(memory);
      take_row_times_of_points(memory, limits);
    }
    const auto references = static_cast<std::size_t>(limits.references);
    for (std::size_t r = 0; r < references; ++r) take_row_times(memory, limits);
    reserve_tracking(memory, limits.keypoints, limits.width, limits.height);
    reserve_line_tracking(memory, limits.segments);
    reserve_noise_learning(memory, limits);
    size_motion(memory, references, static_cast<std::size_t>(limits.keypoints),
                static_cast<std::size_t>(limits.segments), static_cast<std::size_t>(limits.surfaces));
  }

  // Keeps the image of the frame with this stamp, for align(), until the next call.
  void keep_image(const Pyramid& pyramid, std::int64_t stamp_ns) { alignment_.keep(pyramid, stamp_ns); }

  // Finds T_current_reference of the reference whose image was kept, by sparse image alignment, from its
  // prediction. Returns false for any other reference, and where the alignment cannot be trusted.
  bool align(const Reference& reference, const CurrentFrame& current, Se3& T_current_reference) const;
  // Finds T_current_reference of one reference; features are searched within radius_px of the positions that
  // T_predicted puts them at. Without registration this is the whole estimate.
  void find(const Reference& reference, const CurrentFrame& current, const Se3& T_predicted, double radius_px,
            TrackedMotion& tracked);
  // Estimates the motion from the base with all references at once (1 … Limits::references), registered from
  // T_current_base. leads_on: if the result is another motion (is_other), the caller refines again from it,
  // so it has no shifts.
  void refine(std::span<const Reference> references, const CurrentFrame& current, const Se3& T_current_base,
              bool leads_on, TrackedMotion& tracked);

  // A rough estimate from a sample of the points and the lines, at a fifth of the cost: it tells which of two
  // motions to start from.
  void glance(std::span<const Reference> references, const CurrentFrame& current, const Se3& T_current_base,
              TrackedMotion& tracked);

  // Keeps the last estimate, in scratch memory that is taken with the first one: kept is null before.
  void keep(const TrackedMotion& tracked, Arena& scratch, KeptEstimate*& kept) const;
  // Makes the kept estimate the last one. The numbers of iterations stay those of all estimates. What
  // only an estimate reads is not put back.
  void put_back(const KeptEstimate& kept, TrackedMotion& tracked);

  // Tracks of the last call, in the order of its references.
  const ReferenceTracks& tracks(std::size_t reference) const { return tracks_[reference]; }

 private:
  constexpr void allocate_matches(Arena& memory, const Limits& limits) {
    for (std::size_t r = 0; r < static_cast<std::size_t>(limits.references); ++r)
      tracks_[r].allocate_matches(memory, limits);
  }
  // What an estimate needs besides the matches (tracks_): the features of each reference after
  // row-time compensation, which lie in the scratch, and the poses of the references.
  struct Association {
    std::array<RowTimeCompensation, kMaxReferences> features;
    std::size_t references = 0;
    MotionReferences poses;
    bool chained = true;
    // Indices into the poses: the latest reference, and the last good frame.
    std::size_t latest = 0, last_frame = kLastGoodPose;
  };
  static void set_poses(std::span<const Reference> references, const MotionReference& last,
                        Association& association);
  void associate_by_descriptor(const Reference& reference, const CurrentFrame& current,
                               const Se3& T_predicted, double radius_px, Association& association);
  void associate_by_motion(std::span<const Reference> references, const CurrentFrame& current,
                           const Se3& T_current_base, Association& association, bool is_whole);
  void look_beside_stayed(std::span<const Reference> references, const CurrentFrame& current,
                          const Association& association, MotionStart& start, TrackedMotion& tracked);
  void estimate(const Association& association, const CurrentFrame& current, const MotionStart& start,
                const LmOptions& lm, TrackedMotion& tracked);

  std::array<ReferenceTracks, kMaxReferences> tracks_;
  std::span<std::byte> matches_;  // memory of their allocate_matches
  SparseAlignment alignment_;
};

}  // namespace plvo
