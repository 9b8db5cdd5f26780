// SPDX-License-Identifier: Apache-2.0
// The public API itself: which input is refused, and the order in which a frame passes through the modules.
#include "plvo/odometry/odometry.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace plvo {

// Defined here, not in the header, so that the user's program does not hold a second copy of this code.
Odometry::Odometry() = default;

// init and track are never inlined: their stack need is documented, and a tool finds it in the call graph by
// their names.
[[gnu::noinline]] Status Odometry::init(std::span<std::byte> memory, const CameraModel& camera,
                                        const Config& config, const Limits& limits) {
  // Constructed in place: a temporary on the stack would fill the whole stack of a small board.
  ::new (static_cast<void*>(this)) Odometry;
  if (Status status = camera.validate(); !status.ok()) return status;
  if (Status status = config.validate(); !status.ok()) return status;
  if (Status status = limits.validate(); !status.ok()) return status;
  if (camera.width > limits.width || camera.height > limits.height)
    return Status(StatusCode::kInvalidArgument, "the camera's image is larger than Limits allow: ")
        .append(camera.width)
        .append("x")
        .append(camera.height);
  if (const int references = references_of(config.references.policy); limits.references < references)
    return Status(StatusCode::kInvalidArgument, "config: references.policy needs Limits::references = ")
        .append(references);
  if (config.executor && limits.cores < 2)
    return {StatusCode::kInvalidArgument, "config: executor needs Limits::cores = 2"};
  if (const std::size_t bytes = required_bytes(limits); memory.size() < bytes)
    return Status(StatusCode::kOutOfMemory, "init needs a block of ")
        .append(static_cast<std::ptrdiff_t>(bytes))
        .append(" bytes for these Limits, got ")
        .append(static_cast<std::ptrdiff_t>(memory.size()));
  arena_ = Arena(memory);
  Window::Features features;
  Window::allocate(arena_, limits, features);
  memory_.allocate(arena_, limits);
  arena_.seal();
  memory_.extraction.init(camera, config);
  noise_ = config.noise.initial;
  budget_.init(config.budget, limits);
  window_.init(features, limits.kept_keyframes);
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
  // Within this range the squares of depths and of inverse depths are far from the limits of a double.
  if (!(input.depth.metres_per_unit >= 1e-6 && input.depth.metres_per_unit < 1))
    return {StatusCode::kInvalidArgument, "metres_per_unit of the depth must lie between 1e-6 and 1"};
  if (has_stamp_ && input.stamp_ns <= last_stamp_ns_)
    return {StatusCode::kInvalidArgument, "the frame is not later than the one before; frame ignored"};
  return {};
}

[[gnu::noinline]] TrackResult Odometry::track(const RgbdFrame& input) { return track(input, MotionPrior()); }

// All results leave the library here, so every invalid one is found, whatever its cause.
[[gnu::noinline]] TrackResult Odometry::track(const RgbdFrame& input, const MotionPrior& prior) {
  TrackResult result;
  result.stamp_ns = input.stamp_ns;
  process(input, prior, result);
  if (make_sound(result)) return result;
  forget_world();
  result.T_world_camera = result.T_camera_reference = Se3();
  result.pose_covariance.setZero();
  result.motion_covariance.setZero();
  result.mean_brightness = 0;
  result.returned = false;
  result.state = TrackState::kLost;
  result.status = {
      StatusCode::kDegenerate,
      "lost: the pose came out as numbers that are none; the next usable frame starts a new world"};
  return result;
}

void Odometry::process(const RgbdFrame& input, const MotionPrior& prior, TrackResult& result) {
  const bool has_pose = window_.has_last();
  report(window_[has_pose ? window_.last() : window_.current()].pose,
         has_pose ? window_.last_frame().velocity : Vector6::Zero(), result);
  point_track_count_ = line_track_count_ = segment_count_ = reference_segment_count_ = 0;
  Status status = check(input);
  if (status.ok()) status = prior.validate();
  if (!status.ok()) {
    result.state = TrackState::kLost;
    result.status = status;
    return;
  }
  sense(prior, input.stamp_ns);
  last_stamp_ns_ = input.stamp_ns;
  view_slot_ = window_.current();
  has_stamp_ = true;
  depth_after_colour_s_ = depth_after_colour_s(input);
  const DepthSampler depth = memory_.extraction.depth_sampler(input);
  const Exposure predicted = predict_exposure(input.stamp_ns);
  FrameFeatures& features = window_.begin_frame();
  features.clear(budget_.capacity());
  result.feature_step = budget_.step();
  result.points = points_found_;
  memory_.extraction.extract(input, depth.with(predicted), wants_points(), arena_, features, result);
  TrackedMotion tracked;
  if (window_.has_keyframe()) {
    estimate_motion(depth, tracked, result);
    fill_track_views(tracked.motion);
    if (tracked.motion.status == StatusCode::kOk) {
      accept(depth, tracked, prior, result);
      relocalise(depth, tracked, result);
    } else {
      lose(tracked.motion, prior, result);
    }
  } else if (!resume(depth, prior, tracked, result)) {
    memory_.extraction.lift(depth.with(predicted), noise_, arena_, features);
    memory_.extraction.lift_lines(depth, predicted, noise_, arena_, features.lines, result);
    if (!window_.has_last())
      start_first(prior, result);
    else
      start_again(prior, result);
  }
  segment_count_ = fill_segment_views(features.lines, memory_.segment_views);
  points_found_ = result.points;
  points_found_.matched = points_found_.inliers = 0;
}

// Whether the current frame needs points: always where only descriptors find them again, otherwise if the
// frame will be matched later.
bool Odometry::wants_points() const {
  if (!window_.has_keyframe() || !config().points.registered || relocalisation_is_due()) return true;
  const ReferenceConfig& references = config().references;
  if (references.policy == ReferencePolicy::kPreviousFrame) return true;
  return references_of(references.policy) > 1 && !recent_is_young();
}

// Finds the points of the current frame if they are needed after all. Works only before the frame becomes the
// last one. Not inlined: the sampler would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] void Odometry::find_points(const DepthSampler& depth, TrackResult& result) {
  memory_.extraction.find_points(depth.with(predict_exposure(result.stamp_ns)), arena_,
                                 window_.current_frame().features.points, result);
}

// Describes the points of the current frame when it becomes a keyframe or is searched by descriptors; a
// recent frame is found again by its image. Not inlined, for the same reason as find_points.
[[gnu::noinline]] void Odometry::describe_points(TrackResult& result) {
  memory_.extraction.describe_points(arena_, window_.current_frame().features.points, result);
}

double Odometry::depth_after_colour_s(const RgbdFrame& input) const {
  if (!camera().depth_timing.known) return 0;
  // Stamps farther apart than this do not belong to one frame.
  constexpr double kMost_s = 0.1;
  const double apart = static_cast<double>(input.depth_stamp_ns) - static_cast<double>(input.stamp_ns);
  return std::clamp(apart * 1e-9, -kMost_s, kMost_s) + camera().depth_timing.delay_s;
}

std::span<const Arena::Record> Odometry::memory_records() const { return arena_.records(); }
std::size_t Odometry::memory_used() const { return arena_.used(); }
std::size_t Odometry::memory_peak() const { return arena_.peak(); }

}  // namespace plvo
