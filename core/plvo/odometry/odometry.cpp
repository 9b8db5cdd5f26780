// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/odometry.hpp"

#include <algorithm>
#include <limits>

namespace plvo {
namespace {

constexpr int kNobody = -1;
// A frame with fewer 3D points than this cannot start a trajectory.
constexpr int kMinStartFeatures = 20;

// From an earlier stamp to a later one. Stamps may lie anywhere: a difference that does not fit saturates.
std::int64_t elapsed_ns(std::int64_t from, std::int64_t to) {
  const std::uint64_t elapsed = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  return elapsed > static_cast<std::uint64_t>(kMost) ? kMost : static_cast<std::int64_t>(elapsed);
}

std::size_t view_segments(const LineFeatures& lines, std::span<SegmentView> views) {
  for (std::size_t i = 0; i < lines.segments.size(); ++i) {
    const Segment& segment = lines.segments[i];
    views[i] = {static_cast<float>(segment.a.x()), static_cast<float>(segment.a.y()),
                static_cast<float>(segment.b.x()), static_cast<float>(segment.b.y()), i < lines.count_3d};
  }
  return lines.segments.size();
}

// Why no motion was found, and what would help.
Status explain_loss(const MotionEstimate& motion, const TrackResult& result) {
  Status status(motion.status, "lost: ");
  if (result.points.with_depth + result.lines.with_depth < kMinStartFeatures)
    return status.append("hardly anything to see (dark, blurred, bare, or no depth); keypoints: ")
        .append(result.points.detected);
  switch (motion.status) {
    case StatusCode::kTooFewFeatures:
      return status.append("too few features of the reference were found again: ")
          .append(result.points.matched + result.lines.matched);
    case StatusCode::kNoConsensus:
      return status.append("the matches do not agree on one motion; matches: ")
          .append(result.points.matched + result.lines.matched);
    case StatusCode::kDegenerate:
      return status.append("what is seen leaves some direction of motion open; inliers: ")
          .append(result.points.inliers + result.lines.inliers);
    default:
      return status.append("the motion did not converge; inliers: ")
          .append(result.points.inliers + result.lines.inliers);
  }
}

}  // namespace

Status Odometry::init(std::span<std::byte> memory, const CameraModel& camera, const Config& config,
                      const Limits& limits) {
  *this = Odometry();
  if (Status status = camera.validate(); !status.ok()) return status;
  if (Status status = config.validate(); !status.ok()) return status;
  if (Status status = limits.validate(); !status.ok()) return status;
  if (camera.width > limits.width || camera.height > limits.height)
    return Status(StatusCode::kInvalidArgument, "the camera's image is larger than Limits allow: ")
        .append(camera.width)
        .append("x")
        .append(camera.height);
  if (memory.size() < required_bytes(limits))
    return Status(StatusCode::kOutOfMemory, "init needs a block of ")
        .append(static_cast<std::int64_t>(required_bytes(limits)))
        .append(" bytes for these Limits, got ")
        .append(static_cast<std::int64_t>(memory.size()));
  arena_ = Arena(memory);
  rooms_.carve(arena_, limits);
  arena_.seal();
  camera_ = camera;
  config_ = config;
  rooms_.extraction.init(camera, config);
  rooms_.estimation.init(camera, config);
  ready_ = true;
  return {};
}

Status Odometry::check(const RgbdFrame& frame) const {
  if (!ready_) return {StatusCode::kInvalidArgument, "track() before a successful init()"};
  if (frame.colour.data == nullptr || frame.depth.data == nullptr)
    return {StatusCode::kInvalidArgument, "the frame has no colour or no depth image"};
  if (frame.colour.width != camera_.width || frame.colour.height != camera_.height ||
      frame.depth.width != camera_.width || frame.depth.height != camera_.height)
    return Status(StatusCode::kInvalidArgument, "colour and depth must have the calibration's size, ")
        .append(camera_.width)
        .append("x")
        .append(camera_.height);
  const int bytes_per_pixel = frame.colour.format == PixelFormat::kGray8 ? 1 : 3;
  if (frame.colour.stride_bytes < camera_.width * bytes_per_pixel || frame.depth.stride < camera_.width)
    return {StatusCode::kInvalidArgument, "an image's stride is shorter than its row"};
  // Within this range the squares of depths and of inverse depths are far from the ends of a double's.
  if (!(frame.depth.metres_per_unit >= 1e-6 && frame.depth.metres_per_unit < 1))
    return {StatusCode::kInvalidArgument, "metres_per_unit of the depth must lie between 1e-6 and 1"};
  if (has_stamp_ && frame.stamp_ns <= last_stamp_ns_)
    return {StatusCode::kInvalidArgument, "the frame is not later than the one before; frame ignored"};
  return {};
}

TrackResult Odometry::track(const RgbdFrame& input) {
  TrackResult result;
  result.stamp_ns = input.stamp_ns;
  if (last_ != kNobody) {
    result.T_world_camera = anchor(last_).T_world_camera;
    result.pose_covariance = anchor(last_).covariance;
  }
  point_track_count_ = line_track_count_ = segment_count_ = reference_segment_count_ = 0;
  if (Status status = check(input); !status.ok()) {
    result.state = TrackState::kLost;
    result.status = status;
    return result;
  }
  last_stamp_ns_ = input.stamp_ns;
  view_slot_ = current_;
  has_stamp_ = true;
  const DepthSampler depth = rooms_.extraction.depth_sampler(input);
  rooms_.extraction.extract(input, depth, arena_, frame(current_), result);
  segment_count_ = view_segments(frame(current_).lines, rooms_.segment_views);
  if (reference_ == kNobody) {
    start(result);
    return result;
  }
  MotionEstimate motion = estimate_motion_to(reference_, depth, result);
  int against = reference_;
  if (motion.status != StatusCode::kOk && last_ != reference_) {
    motion = estimate_motion_to(last_, depth, result);
    against = last_;
  }
  fill_views(motion, against);
  if (motion.status == StatusCode::kOk)
    accept(motion, against, result);
  else
    lose(motion, result);
  return result;
}

// The motion from the reference to now, if the camera goes on as it did between the last two good frames.
Se3 Odometry::predict_motion(int reference, std::int64_t stamp_ns) const {
  const Se3 T_last_reference = anchors_[static_cast<std::size_t>(last_)].T_world_camera.inverse() *
                               anchors_[static_cast<std::size_t>(reference)].T_world_camera;
  if (motion_ns_ <= 0) return T_last_reference;
  const std::int64_t elapsed = elapsed_ns(frame(last_).stamp_ns, stamp_ns);
  // Beyond a few frames a prediction is worse than none.
  const double ratio = static_cast<double>(elapsed) / static_cast<double>(motion_ns_);
  if (!(ratio < 3)) return T_last_reference;
  const Vector6 velocity = boxminus(T_last_previous_, Se3{});
  return boxplus(Se3{}, ratio * velocity) * T_last_reference;
}

PairPrior Odometry::prior_of(int reference, std::int64_t stamp_ns) const {
  const Anchor& from = anchors_[static_cast<std::size_t>(reference)];
  PairPrior prior;
  prior.T_current_reference = predict_motion(reference, stamp_ns);
  prior.T_reference_last =
      from.T_world_camera.inverse() * anchors_[static_cast<std::size_t>(last_)].T_world_camera;
  prior.seconds_since_last = static_cast<double>(elapsed_ns(frame(last_).stamp_ns, stamp_ns)) * 1e-9;
  prior.reference_velocity = from.velocity;
  prior.reference_velocity_known = from.velocity_known;
  prior.reference_is_last = reference == last_;
  return prior;
}

MotionEstimate Odometry::estimate_motion_to(int reference, const DepthSampler& depth, TrackResult& result) {
  PairPrior prior = prior_of(reference, result.stamp_ns);
  result.reference_stamp_ns = frame(reference).stamp_ns;
  MotionEstimate motion =
      rooms_.estimation.estimate(frame(reference), frame(current_), rooms_.extraction.pyramid(), depth, prior,
                                 config_.points.search_radius_px, arena_, result);
  if (motion.status == StatusCode::kOk) return motion;
  prior.T_current_reference = Se3{};
  return rooms_.estimation.estimate(frame(reference), frame(current_), rooms_.extraction.pyramid(), depth,
                                    prior, config_.motion.wide_search_px, arena_, result);
}

void Odometry::start(TrackResult& result) {
  if (result.points.with_depth + result.lines.with_depth < kMinStartFeatures) {
    const bool at_start = last_ == kNobody;
    result.state = at_start ? TrackState::kInitialising : TrackState::kLost;
    result.status =
        Status(StatusCode::kTooFewFeatures,
               at_start
                   ? "waiting for a first frame with texture and depth; 3D points and lines in this one: "
                   : "lost: hardly anything to see (dark, blurred, bare, or no depth); 3D points and lines: ")
            .append(result.points.with_depth + result.lines.with_depth);
    return;
  }
  // At the very start the anchor is the world's origin; after a loss the last good pose, whose covariance
  // grows by all the time that nobody saw.
  if (last_ != kNobody) {
    const double seconds = static_cast<double>(elapsed_ns(frame(last_).stamp_ns, result.stamp_ns)) * 1e-9;
    const double sigma_m = config_.motion.unseen_m_per_s * seconds;
    const double sigma_rad = config_.motion.unseen_rad_per_s * seconds;
    for (int i = 0; i < 3; ++i) {
      result.pose_covariance(i, i) += sigma_m * sigma_m;
      result.pose_covariance(3 + i, 3 + i) += sigma_rad * sigma_rad;
    }
  }
  anchor(current_).T_world_camera = result.T_world_camera;
  anchor(current_).covariance = result.pose_covariance;
  anchor(current_).velocity_known = false;
  result.state = TrackState::kInitialising;
  result.reference_stamp_ns = result.stamp_ns;
  reference_ = last_ = current_;
  current_ = (current_ + 1) % 3;
  motion_ns_ = 0;
  lost_frames_ = 0;
}

void Odometry::accept(const MotionEstimate& motion, int against, TrackResult& result) {
  result.state = TrackState::kTracking;
  result.T_camera_reference = motion.T_current_reference;
  result.motion_covariance = motion.C_H;
  const Anchor& from = anchor(against);
  const Se3 T_reference_current = motion.T_current_reference.inverse();
  Se3 T_world_camera = from.T_world_camera * T_reference_current;
  T_world_camera.R = renormalise(T_world_camera.R);
  const Matrix6 covariance = compose_covariance(from.T_world_camera, from.covariance, T_reference_current,
                                                inverse_covariance(motion.T_current_reference, motion.C_H));
  result.T_world_camera = T_world_camera;
  result.pose_covariance = covariance;
  anchor(current_).T_world_camera = T_world_camera;
  anchor(current_).covariance = covariance;

  T_last_previous_ = T_world_camera.inverse() * anchor(last_).T_world_camera;
  motion_ns_ = elapsed_ns(frame(last_).stamp_ns, result.stamp_ns);
  note_velocity();
  lost_frames_ = 0;
  reference_ = against;
  choose_reference(result);
}

// Of the current frame, and so more of the last one.
void Odometry::note_velocity() {
  Anchor& last = anchor(last_);
  Anchor& current = anchor(current_);
  current.velocity = boxminus(T_last_previous_, Se3{}) / (static_cast<double>(motion_ns_) * 1e-9);
  current.velocity_known = true;
  last.velocity = last.velocity_known ? Vector6(0.5 * (last.velocity + current.velocity)) : current.velocity;
  last.velocity_known = true;
}

// The tracked frame becomes the last good one, and the reference too, unless a keyframe goes on being a good
// one.
void Odometry::choose_reference(const TrackResult& result) {
  last_ = current_;
  const FrameFeatures& features = frame(reference_);
  const auto available = static_cast<double>(features.points.keypoints.size() + features.lines.count_3d);
  const bool keep =
      config_.reference == ReferencePolicy::kKeyframe &&
      result.points.inliers + result.lines.inliers >= config_.motion.keyframe_inlier_ratio * available;
  if (!keep) reference_ = last_;
  current_ = 0;
  while (current_ == reference_ || current_ == last_) ++current_;
}

void Odometry::lose(const MotionEstimate& motion, TrackResult& result) {
  result.state = TrackState::kLost;
  result.status = explain_loss(motion, result);
  ++lost_frames_;
  if (lost_frames_ < config_.motion.max_lost_frames) return;
  // Nothing is seen any more of what the reference saw. The next usable frame starts anew at the last good
  // pose.
  reference_ = kNobody;
  current_ = (last_ + 1) % 3;
}

void Odometry::fill_views(const MotionEstimate& motion, int against) {
  const PointTracks& tracks = rooms_.estimation.point_tracks();
  const PointFeatures& reference = frame(against).points;
  const std::span<const std::uint8_t> inliers = rooms_.estimation.point_inliers();
  const bool solved = motion.status == StatusCode::kOk;
  point_track_count_ = tracks.matches.size();
  for (std::size_t i = 0; i < point_track_count_; ++i) {
    const Keypoint& from = reference.keypoints[tracks.matches[i].reference];
    rooms_.point_track_views[i] = {from.u, from.v, static_cast<float>(tracks.pixels[i].x()),
                                   static_cast<float>(tracks.pixels[i].y()), solved && inliers[i] != 0};
  }
  reference_segment_count_ = view_segments(frame(against).lines, rooms_.reference_segment_views);
  const std::span<const Match> matches = rooms_.estimation.line_matches();
  const std::span<const std::uint8_t> line_inliers = rooms_.estimation.line_inliers();
  line_track_count_ = matches.size();
  for (std::size_t i = 0; i < line_track_count_; ++i)
    rooms_.line_track_views[i] = {matches[i].reference, matches[i].current, solved && line_inliers[i] != 0};
}

FeatureView Odometry::features() const {
  FeatureView view;
  if (!ready_ || !has_stamp_) return view;
  view.image = rooms_.extraction.pyramid().level(0);
  view.keypoints = frame(view_slot_).points.keypoints.span();
  view.point_tracks = rooms_.point_track_views.first(point_track_count_);
  view.segments = rooms_.segment_views.first(segment_count_);
  view.reference_segments = rooms_.reference_segment_views.first(reference_segment_count_);
  view.line_tracks = rooms_.line_track_views.first(line_track_count_);
  return view;
}

std::span<const Arena::Record> Odometry::memory_records() const { return arena_.records(); }
std::size_t Odometry::memory_used() const { return arena_.used(); }
std::size_t Odometry::memory_peak() const { return arena_.peak(); }

}  // namespace plvo
