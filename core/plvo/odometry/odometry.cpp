// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/odometry.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include "plvo/odometry/elapsed.hpp"

namespace plvo {
namespace {

// A frame with fewer 3D points than this cannot start a trajectory.
constexpr int kMinStartFeatures = 20;
// Beyond so many times the last motion's own time a prediction is worse than none.
constexpr int kLongestPrediction = 3;

std::size_t view_segments(const LineFeatures& lines, std::span<SegmentView> views) {
  for (std::size_t i = 0; i < lines.segments.size(); ++i) {
    const Segment& segment = lines.segments[i];
    views[i] = {static_cast<float>(segment.a.x()), static_cast<float>(segment.a.y()),
                static_cast<float>(segment.b.x()), static_cast<float>(segment.b.y()), i < lines.count_3d};
  }
  return lines.segments.size();
}

// Why no motion was found, and what would help.
Status explain_loss(const MotionEstimate& motion, const TrackResult& result, const char* first_word) {
  Status status(motion.status, first_word);
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

// Here, not in the header: a user's program need not hold its code once more.
Odometry::Odometry() = default;

Status Odometry::init(std::span<std::byte> memory, const CameraModel& camera, const Config& config,
                      const Limits& limits) {
  // In place: another one on the stack, to be copied from, would be all that the stack of a board holds.
  ::new (static_cast<void*>(this)) Odometry;
  if (Status status = camera.validate(); !status.ok()) return status;
  if (Status status = config.validate(); !status.ok()) return status;
  if (Status status = limits.validate(); !status.ok()) return status;
  if (camera.width > limits.width || camera.height > limits.height)
    return Status(StatusCode::kInvalidArgument, "the camera's image is larger than Limits allow: ")
        .append(camera.width)
        .append("x")
        .append(camera.height);
  if (config.references.policy == ReferencePolicy::kKeyframeAndPrevious && limits.references < 2)
    return {StatusCode::kInvalidArgument,
            "config: references.policy with both references needs Limits::references = 2"};
  if (config.side_by_side && limits.cores < 2)
    return {StatusCode::kInvalidArgument, "config: side_by_side needs Limits::cores = 2"};
  if (memory.size() < required_bytes(limits))
    return Status(StatusCode::kOutOfMemory, "init needs a block of ")
        .append(static_cast<std::ptrdiff_t>(required_bytes(limits)))
        .append(" bytes for these Limits, got ")
        .append(static_cast<std::ptrdiff_t>(memory.size()));
  arena_ = Arena(memory);
  std::array<FrameFeatures, kFrames> features;
  rooms_.carve(arena_, limits, features);
  for (std::size_t i = 0; i < kFrames; ++i) frames_[i].features = features[i];
  arena_.seal();
  rooms_.extraction.init(camera, config);
  noise_ = config.noise.initial;
  budget_.init(config.budget, limits);
  kept_.init(limits.kept_keyframes);
  ready_ = true;
  return {};
}

Status Odometry::check(const RgbdFrame& input) const {
  if (!ready_) return {StatusCode::kInvalidArgument, "track() before a successful init()"};
  if (input.colour.data == nullptr || input.depth.data == nullptr)
    return {StatusCode::kInvalidArgument, "the frame has no colour or no depth image"};
  if (input.colour.width != camera().width || input.colour.height != camera().height ||
      input.depth.width != camera().width || input.depth.height != camera().height)
    return Status(StatusCode::kInvalidArgument, "colour and depth must have the calibration's size, ")
        .append(camera().width)
        .append("x")
        .append(camera().height);
  const int bytes_per_pixel = input.colour.format == PixelFormat::kGray8 ? 1 : 3;
  if (input.colour.stride_bytes < camera().width * bytes_per_pixel || input.depth.stride < camera().width)
    return {StatusCode::kInvalidArgument, "an image's stride is shorter than its row"};
  // Within this range the squares of depths and of inverse depths are far from the ends of a double's.
  if (!(input.depth.metres_per_unit >= 1e-6 && input.depth.metres_per_unit < 1))
    return {StatusCode::kInvalidArgument, "metres_per_unit of the depth must lie between 1e-6 and 1"};
  if (has_stamp_ && input.stamp_ns <= last_stamp_ns_)
    return {StatusCode::kInvalidArgument, "the frame is not later than the one before; frame ignored"};
  return {};
}

TrackResult Odometry::track(const RgbdFrame& input) { return track(input, MotionPrior()); }

TrackResult Odometry::track(const RgbdFrame& input, const MotionPrior& prior) {
  TrackResult result;
  result.stamp_ns = input.stamp_ns;
  const bool has_pose = last_ != kNobody;
  result.T_world_camera = has_pose ? frame(last_).T_world_camera : start_.T_world_camera;
  result.pose_covariance = has_pose ? frame(last_).covariance : start_.covariance;
  point_track_count_ = line_track_count_ = segment_count_ = reference_segment_count_ = 0;
  Status status = check(input);
  if (status.ok()) status = prior.validate();
  if (!status.ok()) {
    result.state = TrackState::kLost;
    result.status = status;
    return result;
  }
  sense(prior, input.stamp_ns);
  last_stamp_ns_ = input.stamp_ns;
  view_slot_ = current_;
  has_stamp_ = true;
  depth_after_colour_s_ = depth_after_colour_s(input);
  const DepthSampler depth = rooms_.extraction.depth_sampler(input);
  const Exposure predicted = predict_exposure(input.stamp_ns);
  take_feature_memory();
  FrameFeatures& features = frame(current_).features;
  features.clear(budget_.room());
  result.feature_step = budget_.step();
  rooms_.extraction.extract(input, depth.with(predicted), arena_, features, result);
  TrackedMotion tracked;
  if (keyframe_ != kNobody) {
    estimate_motion(depth, tracked, result);
    fill_views(tracked.motion);
    if (tracked.motion.status == StatusCode::kOk) {
      rooms_.extraction.lift(depth.with(tracked.exposure), noise_, arena_, features);
      accept(tracked, prior, result);
      look_back(depth, tracked, result);
    } else {
      lose(tracked.motion, prior, result);
    }
  } else if (!resume(depth, prior, tracked, result)) {
    rooms_.extraction.lift(depth.with(predicted), noise_, arena_, features);
    rooms_.extraction.lift_lines(depth, predicted, noise_, arena_, features.lines, result);
    start(prior, result);
  }
  segment_count_ = view_segments(features.lines, rooms_.segment_views);
  return result;
}

// Limits for one reference have memory for the features of two frames: the reference, and the current frame,
// which takes it from the last one.
void Odometry::take_feature_memory() {
  FrameFeatures& mine = frame(current_).features;
  for (int slot = 0; slot < static_cast<int>(kFrames) && mine.points.points.empty(); ++slot) {
    if (slot == keyframe_ || kept_.holds(slot)) continue;
    std::swap(mine.points, frame(slot).features.points);
    std::swap(mine.lines, frame(slot).features.lines);
    std::swap(mine.surfaces, frame(slot).features.surfaces);
  }
}

double Odometry::depth_after_colour_s(const RgbdFrame& input) const {
  if (!camera().depth_timing.known) return 0;
  // Stamps farther apart than this do not belong to one frame, whoever paired them.
  constexpr double kMost_s = 0.1;
  const double apart = static_cast<double>(input.depth_stamp_ns) - static_cast<double>(input.stamp_ns);
  return std::clamp(apart * 1e-9, -kMost_s, kMost_s) + camera().depth_timing.delay_s;
}

// How the camera moves while the frame is exposed, if it goes on as it did.
Exposure Odometry::predict_exposure(std::int64_t stamp_ns) const {
  if (last_ == kNobody) return {};
  const PairPrior prior = prior_of(last_, stamp_ns);
  return current_exposure(camera(), prior, prior.T_current_reference);
}

// The motion from the reference to now: as other sensors tell it, or if the camera goes on as it did between
// the last two good frames.
Se3 Odometry::predict_motion(int reference, std::int64_t stamp_ns) const {
  const Frame& last = frame(last_);
  const Se3 T_last_reference = last.T_world_camera.inverse() * frame(reference).T_world_camera;
  if (sensed_.known()) return sensed_.T_current_last() * T_last_reference;
  const auto elapsed = static_cast<double>(elapsed_ns(last.features.stamp_ns, stamp_ns));
  if (!(elapsed < kLongestPrediction * static_cast<double>(last.motion_ns))) return T_last_reference;
  return boxplus(Se3{}, elapsed * 1e-9 * last.velocity) * T_last_reference;
}

PairPrior Odometry::prior_of(int reference, std::int64_t stamp_ns) const {
  const Frame& from = frame(reference);
  const Frame& last = frame(last_);
  PairPrior prior;
  prior.T_current_reference = predict_motion(reference, stamp_ns);
  prior.T_reference_last = from.T_world_camera.inverse() * last.T_world_camera;
  prior.seconds_since_last = static_cast<double>(elapsed_ns(last.features.stamp_ns, stamp_ns)) * 1e-9;
  prior.reference_velocity = from.velocity;
  prior.reference_velocity_known = from.motion_ns > 0;
  prior.reference_is_last = reference == last_;
  prior.depth_after_colour_s = depth_after_colour_s_;
  return prior;
}

// The keyframe, which is the base, and the last good frame, as far as the policy wants both.
std::size_t Odometry::choose_references(std::int64_t stamp_ns, References& references) const {
  const MotionReference last = last_from_keyframe();
  references[0] = {&frame(keyframe_).features, prior_of(keyframe_, stamp_ns), {}, last};
  if (!uses_both_references()) return 1;
  references[1] = {&frame(last_).features, prior_of(last_, stamp_ns), last, {}};
  return 2;
}

// A first motion from the latest reference: by its image; failing that by its features, where they are
// predicted; failing that from each, wherever it may be, unless other sensors say where. Then the motion from
// all of them.
void Odometry::estimate_motion(const DepthSampler& depth, TrackedMotion& tracked, TrackResult& result) {
  References references;
  const std::size_t count = choose_references(result.stamp_ns, references);
  const CurrentFrame current{frame(current_).features, rooms_.extraction, depth, noise_, sensed_};
  result.reference_stamp_ns = frame(keyframe_).features.stamp_ns;
  const Reference& latest = references[count - 1];
  Se3 T_current_latest;
  if (config().points.registered &&
      rooms_.tracking.align(latest, current, arena_, T_current_latest, result)) {
    rooms_.tracking.refine(std::span(references).first(count), current,
                           T_current_latest * latest.pose.T_reference_base, arena_, tracked, result);
    if (tracked.motion.status == StatusCode::kOk) return;
  }
  for (std::size_t attempt = 0; attempt <= count; ++attempt) {
    const bool wide = attempt > 0;
    Reference from = references[count - (wide ? attempt : 1)];
    if (wide && !sensed_.known()) from.prior.T_current_reference = Se3{};
    rooms_.tracking.find(from, current,
                         wide ? config().references.wide_search_px : config().points.match.radius_px, arena_,
                         tracked, result);
    if (tracked.motion.status != StatusCode::kOk) continue;
    if (!config().points.registered) return;
    const Se3 T_current_base = tracked.motion.T_current_reference * from.pose.T_reference_base;
    rooms_.tracking.refine(std::span(references).first(count), current, T_current_base, arena_, tracked,
                           result);
    if (tracked.motion.status == StatusCode::kOk) return;
  }
}

void Odometry::start(const MotionPrior& prior, TrackResult& result) {
  const bool at_start = last_ == kNobody;
  if (result.points.with_depth + result.lines.with_depth < kMinStartFeatures) {
    result.state = at_start ? TrackState::kInitialising : TrackState::kLost;
    result.status =
        Status(StatusCode::kTooFewFeatures,
               at_start
                   ? "waiting for a first frame with texture and depth; 3D points and lines in this one: "
                   : (sensed_.known() ? "predicted: " : "lost: "))
            .append(at_start
                        ? ""
                        : "hardly anything to see (dark, blurred, bare, or no depth); 3D points and lines: ")
            .append(result.points.with_depth + result.lines.with_depth);
    if (sensed_.known()) (void)predicted_pose(prior, result);
    return;
  }
  const bool levels = at_start && config().level_world && !start_is_set_;
  if (levels && !prior.gravity) {
    result.state = TrackState::kInitialising;
    result.status = {
        StatusCode::kNotFound,
        "waiting for gravity: Config::level_world wants the first frame's prior to say where down "
        "is"};
    return;
  }
  // At the very start the anchor is the world's origin; after a loss what the priors make of the last good
  // pose, or itself, whose covariance grows by all the time that nobody saw.
  HeldPose pose = start_;
  if (levels) {
    gravity_.level(*prior.gravity, pose);
    result.T_world_camera = pose.T_world_camera;
    result.pose_covariance = pose.covariance;
  } else if (!at_start && sensed_.known()) {
    pose = predicted_pose(prior, result);
    result.status = {};
  } else {
    if (!at_start) {
      pose = held(last_);
      grow_unseen(result.stamp_ns, pose.covariance);
    }
    HeldPose itself = pose;
    if (prior.gravity) gravity_.read(*prior.gravity, itself, pose);
    result.T_world_camera = pose.T_world_camera;
    result.pose_covariance = pose.covariance;
  }
  hold(current_, pose);
  Frame& current = frame(current_);
  current.motion_covariance.setZero();
  current.motion_ns = 0;
  result.T_camera_reference = Se3();
  result.motion_covariance.setZero();
  result.state = TrackState::kInitialising;
  result.reference_stamp_ns = result.stamp_ns;
  keyframe_ = last_ = current_;
  keep_image();
  current_ = free_slot();
  lost_frames_ = 0;
  sensed_.restart();
}

// The last good pose's covariance by now, when nobody saw the motion since.
void Odometry::grow_unseen(std::int64_t stamp_ns, Matrix6& covariance) const {
  const double seconds = static_cast<double>(elapsed_ns(frame(last_).features.stamp_ns, stamp_ns)) * 1e-9;
  const double sigma_m = config().references.unseen_m_per_s * seconds;
  const double sigma_rad = config().references.unseen_rad_per_s * seconds;
  for (int i = 0; i < 3; ++i) {
    covariance(i, i) += sigma_m * sigma_m;
    covariance(3 + i, 3 + i) += sigma_rad * sigma_rad;
  }
}

void Odometry::accept(const TrackedMotion& tracked, const MotionPrior& prior, TrackResult& result) {
  const MotionEstimate& motion = tracked.motion;
  result.state = TrackState::kTracking;
  result.T_camera_reference = motion.T_current_reference;
  result.motion_covariance = motion.C_H;
  HeldPose from = held(keyframe_);
  HeldPose pose = advance(from, motion.T_current_reference, motion.C_H);
  if (prior.gravity) {
    // The last frame's pose is not needed again but for the velocity: it moves with the keyframe's.
    const Se3 T_last_keyframe = last_from_keyframe().T_reference_base;
    gravity_.read(*prior.gravity, from, pose);
    hold(keyframe_, from);
    if (keyframe_ != last_) frame(last_).T_world_camera = from.T_world_camera * T_last_keyframe.inverse();
  }
  result.T_world_camera = pose.T_world_camera;
  result.pose_covariance = pose.covariance;
  hold(current_, pose);
  frame(current_).motion_covariance = motion.C_H;
  note_velocity(elapsed_ns(frame(last_).features.stamp_ns, result.stamp_ns));
  lost_frames_ = 0;
  sensed_.restart();
  learn(config().noise, tracked.shown, noise_);
  choose_keyframe();
}

// Of the current frame, and so more of the last one.
void Odometry::note_velocity(std::int64_t motion_ns) {
  Frame& last = frame(last_);
  Frame& current = frame(current_);
  const Se3 T_current_last = current.T_world_camera.inverse() * last.T_world_camera;
  current.velocity = boxminus(T_current_last, Se3{}) / (static_cast<double>(motion_ns) * 1e-9);
  current.motion_ns = motion_ns;
  last.velocity = last.motion_ns > 0 ? Vector6(0.5 * (last.velocity + current.velocity)) : current.velocity;
  last.motion_ns = motion_ns;
}

// The tracked frame becomes the last good one, and the keyframe too, unless the keyframe goes on being a good
// one.
void Odometry::choose_keyframe() {
  last_ = current_;
  const FrameFeatures& features = frame(keyframe_).features;
  // Too full a keyframe for the budget goes on costing what it did.
  const FeatureRoom room = budget_.room();
  const bool affordable =
      features.points.keypoints.size() <= room.keypoints && features.lines.segments.size() <= room.segments;
  const bool keep =
      config().references.policy != ReferencePolicy::kPreviousFrame && affordable && still_seen(keyframe_);
  if (!keep) keyframe_ = last_;
  if (!keep || uses_both_references()) keep_image();
  current_ = free_slot();
}

// Of the current frame, which is the latest reference from now on.
void Odometry::keep_image() {
  rooms_.tracking.keep_image(rooms_.extraction.pyramid(), frame(current_).features.stamp_ns);
}

// Whether the last estimate, whose base was that frame, found enough of its features.
bool Odometry::still_seen(int slot) const {
  const FrameFeatures& features = frame(slot).features;
  std::size_t available = features.lines.count_3d;
  for (const Point3d& point : features.points.points.first(features.points.keypoints.size()))
    available += point.p.z() > 0 ? 1 : 0;
  return rooms_.tracking.tracks(0).inliers >=
         config().references.keyframe_inlier_ratio * static_cast<double>(available);
}

int Odometry::free_slot() const {
  int slot = 0;
  while (slot == keyframe_ || slot == last_ || kept_.holds(slot)) ++slot;
  return slot;
}

void Odometry::lose(const MotionEstimate& motion, const MotionPrior& prior, TrackResult& result) {
  result.state = TrackState::kLost;
  result.status = explain_loss(motion, result, sensed_.known() ? "predicted: " : "lost: ");
  if (sensed_.known()) (void)predicted_pose(prior, result);
  ++lost_frames_;
  if (lost_frames_ < config().references.max_lost_frames) return;
  // Nothing is seen any more of what the reference saw. Unless its view comes back, the next usable frame
  // starts anew at the last good pose.
  kept_.keep(keyframe_);
  keyframe_ = kNobody;
  current_ = free_slot();
}

// Of the latest reference; without a motion there is nothing to show.
void Odometry::fill_views(const MotionEstimate& motion) {
  if (motion.status != StatusCode::kOk) return;
  const bool both = uses_both_references();
  const FrameFeatures& reference = frame(both ? last_ : keyframe_).features;
  const ReferenceTracks& tracks = rooms_.tracking.tracks(both ? 1 : 0);
  point_track_count_ = tracks.points.matches.size();
  for (std::size_t i = 0; i < point_track_count_; ++i) {
    const Keypoint& from = reference.points.keypoints[tracks.points.matches[i].reference];
    const Vector2& to = tracks.points.pixels[i];
    rooms_.point_track_views[i] = {from.u, from.v, static_cast<float>(to.x()), static_cast<float>(to.y()),
                                   tracks.point_inliers[i] != 0};
  }
  reference_segment_count_ = view_segments(reference.lines, rooms_.reference_segment_views);
  line_track_count_ = tracks.lines.size();
  for (std::size_t i = 0; i < line_track_count_; ++i)
    rooms_.line_track_views[i] = {tracks.lines[i].reference, tracks.lines[i].current,
                                  tracks.line_inliers[i] != 0};
}

FeatureView Odometry::features() const {
  FeatureView view;
  if (!ready_ || !has_stamp_) return view;
  view.image = rooms_.extraction.pyramid().level(0);
  view.keypoints = frame(view_slot_).features.points.keypoints.span();
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
