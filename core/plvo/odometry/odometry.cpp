// SPDX-License-Identifier: Apache-2.0
// The public API itself: which input is refused, and the order in which a frame passes through the modules.
#include "plvo/odometry/odometry.hpp"

#include <algorithm>
#include <array>
#include <new>

#include "plvo/odometry/elapsed.hpp"
#include "plvo/odometry/stamp_error.hpp"

namespace plvo {
namespace {

Status check_mask(GrayView mask, const CameraModel& camera, const Limits& limits) {
  if (mask.data == nullptr) return {};
  if (!limits.mask) return {StatusCode::kInvalidArgument, "config: mask needs Limits::mask = true"};
  if (mask.width != camera.width || mask.height != camera.height)
    return Status(StatusCode::kInvalidArgument, "config: mask must have the size of the camera's images, ")
        .append(camera.width)
        .append("x")
        .append(camera.height)
        .append(", not ")
        .append(mask.width)
        .append("x")
        .append(mask.height);
  if (mask.stride < mask.width)
    return {StatusCode::kInvalidArgument, "config: the stride of mask is shorter than its row"};
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask.at(x, y) != 0) return {};
  return {StatusCode::kInvalidArgument, "config: mask leaves no pixel to be used: its pixels are all 0"};
}

}  // namespace

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
  if (Status status = check_mask(config.mask, camera, limits); !status.ok()) return status;
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
  camera_ = camera;
  config_ = config;
  memory_.extraction.init(camera_, config_->mask);
  noise_ = initial_scales(config.noise);
  disagreement_ = {};
  parallax_ = {};
  budget_.init(config.budget, limits);
  window_.init(features, limits.kept_keyframes);
  carried_.init(camera_.width, camera_.height);
  return {};
}

[[gnu::noinline]] TrackResult Odometry::track(const RgbdFrame& input) { return track(input, MotionPrior()); }

// All results leave the library here, so every invalid one is found, whatever its cause.
[[gnu::noinline]] TrackResult Odometry::track(const RgbdFrame& input, const MotionPrior& prior) {
  memory_.views.clear();
  const Status refusal = check(input, prior);
  if (refusal.ok()) {
    colour_.look(input, config_->mask);
    depth_.look(input, config_->mask);
  }
  // After a lost frame, the motion is searched even if the image is repeated: a prediction would hide the
  // loss.
  const bool is_passed_over = window_.has_last() && !lost_since_ns_ && colour_.is_repeated();
  TrackResult result = !refusal.ok()    ? refuse(input, refusal)
                       : is_passed_over ? pass_over(input, prior)
                                        : process(input, prior);
  if (make_sound(result)) return result;
  forget_world();
  result.world = world_;
  result.T_world_camera = result.T_camera_reference = Se3();
  result.pose_covariance.setZero();
  result.motion_covariance.setZero();
  result.mean_brightness = 0;
  result.disagreement = 1;
  result.relocalised = result.restarted = result.repeated = false;
  result.state = TrackState::kLost;
  result.status = {StatusCode::kDegenerate,
                   "lost: the computed pose is not finite; the next usable frame starts a new world"};
  return result;
}

TrackResult Odometry::track(const RgbdFrame& input, ImuIntegrator& imu, const MotionPrior& wheels) {
  MotionPrior prior = wheels;
  if (check(input, prior).ok()) prior = imu.prior(input.stamp_ns);
  if (!prior.rotation) prior.rotation = wheels.rotation;
  prior.translation = wheels.translation;
  const TrackResult result = track(input, prior);
  if (const std::optional<ObservedRotation> observed = observed_rotation(result)) imu.correct(*observed);
  return result;
}

// A frame that passed check() and is not passed over, step by step.
TrackResult Odometry::process(const RgbdFrame& input, const MotionPrior& prior) {
  // Image: grey, without distortion, as a pyramid.
  StageTimes times{};
  const StageContext context{
      camera_, *config_, noise_, arena_, times, carried_, depth_.is_repeated() ? nullptr : &parallax_};
  FeatureExtraction& extraction = memory_.extraction;
  const double brightness = extraction.prepare_image(context, input.colour);

  // Predict: the motion since each reference, and that during the exposure.
  std::array<Reference, kMaxReferences> references;
  const PredictedMotion predicted =
      predict(window_, camera_, input.stamp_ns, propagate(input.stamp_ns, prior),
              depth_after_colour_s(camera_, depth_.first_stamp_ns(), input.stamp_ns), references);

  // Associate and estimate: try one first motion after the other, until one is accepted.
  const DepthSampler depth = extraction.depth_sampler(input, config_->depth_noise);
  const CurrentFrame frame{context, extraction, depth, predicted, window_.begin_frame(), prior};
  frame.features.clear(budget_.capacity());
  frame.features.stamp_ns = input.stamp_ns;
  extraction.detect(context, depth.with(predicted.exposure), wants_points(), frame.features);
  TrackedMotion tracked;
  if (!depth_.has_stopped()) search(frame, tracked);

  // Decide: what the frame is, and which references stay. Update: the window, the world, the learnt noise.
  TrackResult result = conclude(frame, tracked);

  // Relocalise: correct all poses if the view of an earlier keyframe is back.
  if (result.state == TrackState::kTracking && !result.relocalised) relocalise(frame, tracked, result);
  result.ransac_iterations = tracked.ransac_iterations;
  result.lm_iterations = tracked.lm_iterations;
  result.mean_brightness = brightness;
  result.stage_ns = times;
  return result;
}

// Not inlined, like the steps that it calls: each step then occupies the stack only while it runs.
[[gnu::noinline]] TrackResult Odometry::conclude(const CurrentFrame& frame, const TrackedMotion& tracked) {
  const Decision decision = decide(frame, tracked);
  return update(frame, decision, tracked);
}

Status Odometry::check(const RgbdFrame& input, const MotionPrior& prior) const {
  if (!config_) return {StatusCode::kInvalidArgument, "track() before a successful init()"};
  if (input.colour.data == nullptr || input.depth.data == nullptr)
    return {StatusCode::kInvalidArgument, "the frame has no colour or no depth image"};
  if (input.colour.width != camera_.width || input.colour.height != camera_.height ||
      input.depth.width != camera_.width || input.depth.height != camera_.height)
    return Status(StatusCode::kInvalidArgument, "colour and depth must have the calibration's size, ")
        .append(camera_.width)
        .append("x")
        .append(camera_.height);
  const int bytes_per_pixel = input.colour.format == PixelFormat::kGray8 ? 1 : 3;
  if (input.colour.stride_bytes < camera_.width * bytes_per_pixel || input.depth.stride < camera_.width)
    return {StatusCode::kInvalidArgument, "an image's stride is shorter than its row"};
  // Within this range the squares of depths and of inverse depths are far from the limits of a double.
  if (!(input.depth.metres_per_unit >= 1e-6 && input.depth.metres_per_unit < 1))
    return {StatusCode::kInvalidArgument, "metres_per_unit of the depth must lie between 1e-6 and 1"};
  if (last_stamp_ns_ && input.stamp_ns <= *last_stamp_ns_)
    return {StatusCode::kInvalidArgument,
            "the stamp is not later than that of the frame before; the frame is ignored"};
  return prior.validate();
}

// The pose stays that of the last good frame.
[[gnu::noinline]] TrackResult Odometry::refuse(const RgbdFrame& input, const Status& refusal) const {
  TrackResult result;
  result.stamp_ns = input.stamp_ns;
  result.world = world_;
  result.state = TrackState::kLost;
  result.status = refusal;
  const bool has_pose = window_.has_last();
  report_pose(window_[has_pose ? window_.last() : window_.current()].pose,
              has_pose ? window_.last_frame().velocity.value : Vector6::Zero(), camera_.stamp_sigma_s,
              result);
  return result;
}

// A repeated colour image shows no motion: the pose at the stamp is predicted, by the priors or by the last
// velocity. Only the propagated prior and the last stamp change.
[[gnu::noinline]] TrackResult Odometry::pass_over(const RgbdFrame& input, const MotionPrior& prior) {
  propagated_prior_ = propagate(input.stamp_ns, prior);
  last_stamp_ns_ = input.stamp_ns;
  Se3 T_current_last = propagated_prior_.T_current_last();
  Matrix6 covariance = propagated_prior_.covariance();
  const Window::Frame& last = window_.last_frame();
  if (!propagated_prior_.known()) {
    const std::int64_t elapsed = elapsed_ns(last.features.stamp_ns, input.stamp_ns);
    // An image that repeats for longer than one interval shows a camera at rest in a simulator without noise,
    // or comes from a driver that has stopped.
    T_current_last = coasted_motion(last.velocity, std::min(elapsed, last.velocity.measured_ns));
    covariance.setZero();
    add_process_noise(config_->references, static_cast<double>(elapsed) * 1e-9, covariance);
  }
  const SensedPose predicted = pose_after(window_, gravity_, T_current_last, covariance, prior);
  TrackResult result;
  result.state = TrackState::kTracking;
  result.status = {StatusCode::kOk, "the colour image repeats the one before: the pose is predicted"};
  result.repeated = true;
  result.world = world_;
  result.stamp_ns = input.stamp_ns;
  result.reference_stamp_ns = window_[window_.base()].features.stamp_ns;
  result.T_camera_reference = predicted.T_camera_reference;
  result.motion_covariance = predicted.motion_covariance;
  result.feature_step = budget_.step();
  report_pose(predicted.pose, last.velocity.value, camera_.stamp_sigma_s, result);
  return result;
}

// The motion since the last good frame by other sensors, up to a frame with this prior.
PropagatedPrior Odometry::propagate(std::int64_t stamp_ns, const MotionPrior& prior) const {
  PropagatedPrior sensed = propagated_prior_;
  if (!window_.has_last()) return sensed;
  const Window::Frame& last = window_.last_frame();
  const double moved_s = last.velocity.moving_s(elapsed_ns(last.features.stamp_ns, stamp_ns)) -
                         last.velocity.moving_s(elapsed_ns(last.features.stamp_ns, *last_stamp_ns_));
  sensed.extend(prior, moved_s * last.velocity.value,
                static_cast<double>(elapsed_ns(*last_stamp_ns_, stamp_ns)) * 1e-9, config_->references);
  return sensed;
}

// Whether the current frame needs points: always where only descriptors find them again, otherwise if the
// frame will be matched later.
bool Odometry::wants_points() const {
  if (!window_.has_keyframe() || !config_->points.registered) return true;
  if (relocalisation_.is_due(window_.kept())) return true;
  const ReferencePolicy policy = config_->references.policy;
  if (policy == ReferencePolicy::kPreviousFrame) return true;
  return references_of(policy) > 1 && !window_.recent_is_young();
}

void Odometry::reset() {
  if (!config_) return;
  forget_world();
  world_is_lost_ = false;
  points_found_ = {};
  window_.reset();
  view_slot_ = window_.current();
  noise_ = initial_scales(config_->noise);
  last_stamp_ns_.reset();
  colour_.forget();
  depth_.forget();
  carried_.forget();
  memory_.views.clear();
}

FeatureView Odometry::features() const {
  if (!last_stamp_ns_) return {};
  FeatureView view = memory_.views.view();
  view.image = memory_.extraction.pyramid().level(0);
  view.keypoints = window_[view_slot_].features.points.keypoints.span();
  return view;
}

KeyframeView Odometry::keyframe() const {
  if (!window_.has_keyframe()) return {};
  const Window::Frame& keyframe = window_[window_.keyframe()];
  return {&keyframe.features, keyframe.pose.T_world_camera, keyframe.velocity.value};
}

std::span<const Arena::Record> Odometry::memory_records() const { return arena_.records(); }
std::size_t Odometry::memory_used() const { return arena_.used(); }
std::size_t Odometry::memory_peak() const { return arena_.peak(); }

}  // namespace plvo
