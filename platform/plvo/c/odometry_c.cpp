// SPDX-License-Identifier: Apache-2.0
// The odometry behind plvo.h. Its handle stands at the front of the caller's block; the core's memory
// follows.
#include <algorithm>
#include <new>
#include <span>
#include <type_traits>

#include "plvo/c/boundary.hpp"
#include "plvo/c/matrices.hpp"
#include "plvo/c/odometry_handle.hpp"
#include "plvo/c/plvo.h"
#include "plvo/motion/wheel_prior.hpp"
#include "plvo/odometry/odometry.hpp"

static_assert(std::is_trivially_destructible_v<plvo_odometry>,
              "it is never destroyed: the caller only frees its memory");

namespace {

using plvo::Status;
using plvo::StatusCode;
using plvo::c::matrix;
using plvo::c::put;
using plvo::c::refuse;
using plvo::c::to_c;
using plvo::c::vector3;

constexpr std::size_t kHandleBytes = plvo::align_up(sizeof(plvo_odometry));

plvo_limits to_c(const plvo::Limits& limits) {
  return {sizeof(plvo_limits), limits.width,      limits.height,      limits.keypoints,
          limits.segments,     limits.references, limits.line_bands,  limits.kept_keyframes,
          limits.cores,        limits.surfaces,   limits.mask ? 1 : 0};
}

plvo_config default_config() {
  plvo_config config;
  std::memset(&config, 0, sizeof config);
  config.struct_size = sizeof config;
  config.seed = plvo::Config().seed;
  const plvo::BudgetConfig budget;
  config.budget_patience_frames = budget.patience_frames;
  config.budget_spare_share = budget.spare_share;
  return config;
}

Status take_limits(const plvo_limits* given, plvo::Limits& limits) {
  if (given == nullptr) return {};
  plvo_limits whole = to_c(limits);
  if (Status status = plvo::c::take_struct(given, whole, "limits"); !status.ok()) return status;
  limits = {
      .width = whole.width,
      .height = whole.height,
      .keypoints = whole.keypoints,
      .segments = whole.segments,
      .references = whole.references != 0 ? whole.references : limits.references,
      .line_bands = whole.line_bands != 0 ? whole.line_bands : limits.line_bands,
      .kept_keyframes = whole.kept_keyframes,
      .cores = whole.cores != 0 ? whole.cores : limits.cores,
      .surfaces = whole.surfaces,
      .mask = whole.mask != 0,
  };
  return limits.validate();
}

constexpr std::int64_t kMostStride = std::int64_t{1} << 30;  // bytes
constexpr const char* kNoPreset = "preset must be one of PLVO_PRESET_…";

// The functions of a config that was taken. Called with the handle, they call the caller's own.
void take_functions(const plvo_config* given, plvo_odometry& handle, plvo::Config& config) {
  plvo_config whole = default_config();
  if (given == nullptr || !plvo::c::take_struct(given, whole, "config").ok()) return;
  handle.stage_hook = whole.stage_hook;
  handle.stage_hook_context = whole.stage_hook_context;
  handle.executor = whole.executor;
  handle.runner = whole.executor_runner;
  if (handle.stage_hook != nullptr)
    config.stage_hook = {[](void* self, plvo::Stage stage) {
                           const auto& own = *static_cast<const plvo_odometry*>(self);
                           own.stage_hook(own.stage_hook_context, static_cast<std::int32_t>(stage));
                         },
                         &handle};
  if (handle.executor != nullptr)
    config.executor = {[](void* self, plvo::Task here, plvo::Task beside) {
                         const auto& own = *static_cast<const plvo_odometry*>(self);
                         own.executor(own.runner, {here.call, here.context}, {beside.call, beside.context});
                       },
                       &handle};
}

Status take_frame(const plvo_frame* given, plvo::RgbdFrame& frame) {
  plvo_frame whole;
  if (Status status = plvo::c::take_struct(given, whole, "frame"); !status.ok()) return status;
  if (whole.colour_format < PLVO_PIXELS_GRAY8 || whole.colour_format > PLVO_PIXELS_BGR8)
    return refuse("frame: colour_format must be one of PLVO_PIXELS_…");
  constexpr std::int64_t kDepthBytes = sizeof(std::uint16_t);
  if (whole.depth_stride_bytes % kDepthBytes != 0 ||
      reinterpret_cast<std::uintptr_t>(whole.depth) % alignof(std::uint16_t) != 0)
    return refuse("frame: depth and its stride must be multiples of 2 bytes");
  if (std::max(whole.colour_stride_bytes, whole.depth_stride_bytes) > kMostStride)
    return refuse("frame: a stride is longer than 2^30 bytes");
  frame.stamp_ns = whole.stamp_ns;
  frame.depth_stamp_ns = whole.depth_stamp_ns;
  frame.colour = {whole.colour, whole.width, whole.height,
                  static_cast<std::ptrdiff_t>(whole.colour_stride_bytes),
                  static_cast<plvo::PixelFormat>(whole.colour_format)};
  frame.depth = {whole.depth, whole.width, whole.height,
                 static_cast<std::ptrdiff_t>(whole.depth_stride_bytes / kDepthBytes), whole.metres_per_unit};
  return {};
}

Status take_prior(const plvo_prior* given, plvo::MotionPrior& prior) {
  if (given == nullptr) return {};
  plvo_prior whole;
  if (Status status = plvo::c::take_struct(given, whole, "prior"); !status.ok()) return status;
  if (whole.has_rotation != 0)
    prior.rotation = {matrix<3>(whole.R_now_before), matrix<3>(whole.rotation_covariance)};
  if (whole.has_translation != 0)
    prior.translation = {vector3(whole.t_now_before), matrix<3>(whole.translation_covariance)};
  if (whole.has_gravity != 0)
    prior.gravity = {vector3(whole.down), matrix<3>(whole.gravity_covariance), whole.gravity_offset_sigma};
  return prior.validate();
}

plvo_counts to_c(const plvo::FeatureCounts& counts) {
  return {counts.detected, counts.dropped, counts.with_depth, counts.matched, counts.inliers};
}

void give_result(const plvo::TrackResult& result, plvo_result* caller) {
  plvo_result whole;
  std::memset(&whole, 0, sizeof whole);
  whole.state = static_cast<std::int32_t>(result.state);
  whole.stamp_ns = result.stamp_ns;
  whole.reference_stamp_ns = result.reference_stamp_ns;
  put(result.T_world_camera, whole.T_world_camera);
  put(result.pose_covariance, whole.pose_covariance);
  put(result.T_camera_reference, whole.T_camera_reference);
  put(result.motion_covariance, whole.motion_covariance);
  whole.points = to_c(result.points);
  whole.lines = to_c(result.lines);
  whole.ransac_iterations = result.ransac_iterations;
  whole.lm_iterations = result.lm_iterations;
  whole.mean_brightness = result.mean_brightness;
  static_assert(sizeof whole.stage_ns / sizeof *whole.stage_ns == plvo::kStageCount);
  std::copy(result.stage_ns.begin(), result.stage_ns.end(), whole.stage_ns);
  whole.relocalised = result.relocalised ? 1 : 0;
  whole.feature_step = result.feature_step;
  whole.repeated = result.repeated ? 1 : 0;
  whole.world = result.world;
  whole.restarted = result.restarted ? 1 : 0;
  whole.disagreement = result.disagreement;
  plvo::c::give_struct(whole, caller);
}

// Writes up to `capacity` elements and returns how many there are.
template <typename View, typename Element, typename Convert>
std::size_t copy_views(std::span<const View> views, Element* out, std::size_t capacity, Convert convert) {
  if (out != nullptr)
    for (std::size_t i = 0; i < std::min(views.size(), capacity); ++i) out[i] = convert(views[i]);
  return views.size();
}

plvo::FeatureView view_of(const plvo_odometry* odometry) {
  return odometry == nullptr ? plvo::FeatureView() : odometry->odometry.features();
}

plvo_segment segment_to_c(const plvo::SegmentView& segment) {
  return {{segment.a_u, segment.a_v}, {segment.b_u, segment.b_v}, segment.has_3d ? 1 : 0};
}

}  // namespace

plvo::Status plvo::c::take_config(const plvo_config* given, plvo::Config& config) {
  if (given == nullptr) return {};
  plvo_config whole = default_config();
  if (Status status = plvo::c::take_struct(given, whole, "config"); !status.ok()) return status;
  switch (whole.preset) {
    case PLVO_PRESET_DEFAULT: break;
    case PLVO_PRESET_PAPER: config = plvo::Config::paper(); break;
    case PLVO_PRESET_TINY: config = plvo::Config::tiny(); break;
    default: return refuse("config: ").append(kNoPreset);
  }
  switch (whole.features) {
    case PLVO_FEATURES_OF_PRESET: break;
    case PLVO_FEATURES_POINTS: config.features = plvo::Features::kPoints; break;
    case PLVO_FEATURES_LINES: config.features = plvo::Features::kLines; break;
    case PLVO_FEATURES_BOTH: config.features = plvo::Features::kBoth; break;
    default: return refuse("config: features must be one of PLVO_FEATURES_…");
  }
  using plvo::ReferencePolicy;
  switch (whole.reference) {
    case PLVO_REFERENCE_OF_PRESET: break;
    case PLVO_REFERENCE_PREVIOUS: config.references.policy = ReferencePolicy::kPreviousFrame; break;
    case PLVO_REFERENCE_KEYFRAME: config.references.policy = ReferencePolicy::kKeyframe; break;
    case PLVO_REFERENCE_BOTH: config.references.policy = ReferencePolicy::kKeyframeAndPrevious; break;
    case PLVO_REFERENCE_WINDOW: config.references.policy = ReferencePolicy::kWindow; break;
    default: return refuse("config: reference must be one of PLVO_REFERENCE_…");
  }
  config.seed = whole.seed;
  config.stage_clock = whole.stage_clock;
  config.level_world = whole.level_world != 0;
  const std::int64_t stride = whole.mask_stride_bytes != 0 ? whole.mask_stride_bytes : whole.mask_width;
  if (stride > kMostStride) return refuse("config: the stride of mask is longer than 2^30 bytes");
  config.mask = {whole.mask, whole.mask_width, whole.mask_height, static_cast<std::ptrdiff_t>(stride)};
  config.budget.frame_ns = whole.frame_budget_ns;
  if (whole.budget_patience_frames != 0) config.budget.patience_frames = whole.budget_patience_frames;
  if (whole.budget_spare_share != 0) config.budget.spare_share = whole.budget_spare_share;
  return {};
}

const char* plvo_version(void) { return PLVO_VERSION; }

const char* plvo_status_name(std::int32_t code) {
  // Every code of the library is one of the header's, in its order.
  static_assert(static_cast<int>(StatusCode::kNotConverged) == PLVO_NOT_CONVERGED);
  if (code < PLVO_OK || code > PLVO_NOT_CONVERGED) return "unknown";
  return plvo::to_string(static_cast<StatusCode>(code));
}

const char* plvo_state_name(std::int32_t state) {
  static_assert(static_cast<int>(plvo::TrackState::kTracking) == PLVO_TRACKING &&
                static_cast<int>(plvo::TrackState::kPredicted) == PLVO_PREDICTED);
  if (state < PLVO_INITIALISING || state > PLVO_PREDICTED) return "unknown";
  return plvo::to_string(static_cast<plvo::TrackState>(state));
}

void plvo_camera_init(plvo_camera* camera, std::size_t size) {
  plvo::c::init_struct(to_c(plvo::CameraModel()), camera, size);
}
void plvo_limits_init(plvo_limits* limits, std::size_t size) {
  plvo::c::init_struct(to_c(plvo::Limits()), limits, size);
}
void plvo_config_init(plvo_config* config, std::size_t size) {
  plvo::c::init_struct(default_config(), config, size);
}

plvo_status plvo_limits_of_preset(std::int32_t preset, plvo_limits* limits) {
  if (Status status = plvo::c::check_struct(limits, "limits"); !status.ok()) return to_c(status);
  if (preset < PLVO_PRESET_DEFAULT || preset > PLVO_PRESET_TINY) return to_c(refuse(kNoPreset));
  plvo::c::give_struct(to_c(preset == PLVO_PRESET_TINY ? plvo::Limits::tiny() : plvo::Limits()), limits);
  return to_c(Status());
}

void plvo_prior_init(plvo_prior* prior, std::size_t size) {
  plvo_prior nothing;
  std::memset(&nothing, 0, sizeof nothing);
  plvo::c::init_struct(nothing, prior, size);
}

void plvo_quaternion(const double T[12], double xyzw[4]) {
  const plvo::Quaternion q = plvo::to_quaternion(plvo::c::se3(T).R);
  const double values[4] = {q.x, q.y, q.z, q.w};
  std::memcpy(xyzw, values, sizeof values);
}

std::size_t plvo_required_bytes(const plvo_limits* limits) {
  plvo::Limits known;
  if (!take_limits(limits, known).ok()) return 0;
  return plvo::required_bytes(known) + kHandleBytes + plvo::kArenaAlignment;
}

plvo_status plvo_init(void* memory, std::size_t bytes, const plvo_camera* camera, const plvo_config* config,
                      const plvo_limits* limits, plvo_odometry** odometry) {
  if (odometry == nullptr) return to_c(refuse("odometry is NULL: nowhere to put the new one"));
  *odometry = nullptr;
  if (memory == nullptr) return to_c(refuse("memory is NULL"));
  plvo::Limits known_limits;
  if (Status status = take_limits(limits, known_limits); !status.ok()) return to_c(status);
  plvo::Config known_config;
  if (Status status = plvo::c::take_config(config, known_config); !status.ok()) return to_c(status);
  plvo::CameraModel model;
  if (Status status = plvo::c::take_camera(camera, model); !status.ok()) return to_c(status);
  const std::size_t needed = plvo_required_bytes(limits);
  if (bytes < needed) return to_c(plvo::c::too_small("for these limits", needed, bytes));

  const std::span<std::byte> block = plvo::c::aligned_part(memory, bytes);
  auto* handle = new (block.data()) plvo_odometry;
  take_functions(config, *handle, known_config);
  const std::span<std::byte> rest = block.subspan(kHandleBytes);
  const Status status = handle->odometry.init(rest, model, known_config, known_limits);
  if (status.ok()) *odometry = handle;
  return to_c(status);
}

plvo_status plvo_track(plvo_odometry* odometry, const plvo_frame* frame, plvo_result* result) {
  return plvo_track_with_prior(odometry, frame, nullptr, result);
}

plvo_status plvo_track_with_prior(plvo_odometry* odometry, const plvo_frame* frame, const plvo_prior* given,
                                  plvo_result* result) {
  if (odometry == nullptr) return to_c(refuse(plvo::c::kNoOdometry));
  if (Status status = plvo::c::check_struct(result, "result"); !status.ok()) return to_c(status);
  // A frame that cannot be read is tracked as one without images: refused, and the pose is the last one.
  plvo::RgbdFrame view;
  plvo::MotionPrior prior;
  Status unreadable = take_frame(frame, view);
  if (unreadable.ok()) unreadable = take_prior(given, prior);
  const plvo::TrackResult tracked =
      unreadable.ok() ? odometry->odometry.track(view, prior) : odometry->odometry.track(plvo::RgbdFrame());
  give_result(tracked, result);
  return to_c(unreadable.ok() ? tracked.status : unreadable);
}

plvo_status plvo_wheel_prior(const plvo_wheel_step* steps, std::size_t count, double error_s,
                             const double T_base_camera[12], plvo_prior* prior) {
  plvo_prior whole;
  std::memset(&whole, 0, sizeof whole);
  if (Status status = plvo::c::take_struct(prior, whole, "prior"); !status.ok()) return to_c(status);
  if (steps == nullptr || T_base_camera == nullptr) return to_c(refuse("wheels: a pointer is NULL"));
  plvo::BaseMotion motion;
  for (std::size_t i = 0; i < count; ++i) {
    plvo::WheelStep step{steps[i].seconds, {}, matrix<6>(steps[i].covariance)};
    for (int k = 0; k < 6; ++k) step.twist[k] = steps[i].twist[k];
    if (Status status = motion.add(step, error_s); !status.ok()) return to_c(status);
  }
  plvo::MotionPrior made;
  if (Status status = motion.prior(plvo::c::se3(T_base_camera), made); !status.ok()) return to_c(status);
  whole.has_rotation = whole.has_translation = 1;
  put(made.rotation->R_now_before, whole.R_now_before);
  put(made.rotation->covariance, whole.rotation_covariance);
  for (int k = 0; k < 3; ++k) whole.t_now_before[k] = made.translation->t_now_before[k];
  put(made.translation->covariance, whole.translation_covariance);
  plvo::c::give_struct(whole, prior);
  return to_c(Status());
}

plvo_status plvo_frame_took(plvo_odometry* odometry, std::int64_t ns) {
  if (odometry == nullptr) return to_c(refuse(plvo::c::kNoOdometry));
  odometry->odometry.frame_took(ns);
  return to_c(Status());
}

plvo_status plvo_reset(plvo_odometry* odometry) {
  if (odometry == nullptr) return to_c(refuse(plvo::c::kNoOdometry));
  odometry->odometry.reset();
  return to_c(Status());
}

plvo_status plvo_set_pose(plvo_odometry* odometry, const double T[12], const double values[36]) {
  if (odometry == nullptr) return to_c(refuse(plvo::c::kNoOdometry));
  if (T == nullptr || values == nullptr) return to_c(refuse("the pose or its covariance is NULL"));
  return to_c(odometry->odometry.set_pose(plvo::c::se3(T), matrix<6>(values)));
}

std::size_t plvo_keypoints(const plvo_odometry* odometry, plvo_pixel* keypoints, std::size_t capacity) {
  return copy_views(view_of(odometry).keypoints, keypoints, capacity, [](const plvo::Keypoint& keypoint) {
    return plvo_pixel{keypoint.u, keypoint.v};
  });
}
std::size_t plvo_segments(const plvo_odometry* odometry, plvo_segment* segments, std::size_t capacity) {
  return copy_views(view_of(odometry).segments, segments, capacity, segment_to_c);
}
std::size_t plvo_reference_segments(const plvo_odometry* odometry, plvo_segment* segments,
                                    std::size_t capacity) {
  return copy_views(view_of(odometry).reference_segments, segments, capacity, segment_to_c);
}
std::size_t plvo_point_tracks(const plvo_odometry* odometry, plvo_point_track* tracks, std::size_t capacity) {
  return copy_views(view_of(odometry).point_tracks, tracks, capacity, [](const plvo::PointTrackView& track) {
    return plvo_point_track{{track.u_reference, track.v_reference}, {track.u, track.v}, track.inlier ? 1 : 0};
  });
}
std::size_t plvo_line_tracks(const plvo_odometry* odometry, plvo_line_track* tracks, std::size_t capacity) {
  return copy_views(view_of(odometry).line_tracks, tracks, capacity, [](const plvo::LineTrackView& track) {
    return plvo_line_track{track.reference, track.current, track.inlier ? 1 : 0};
  });
}

const std::uint8_t* plvo_image(const plvo_odometry* odometry, std::int64_t* stride_bytes) {
  const plvo::GrayView image = view_of(odometry).image;
  if (stride_bytes != nullptr) *stride_bytes = image.stride;
  return image.data;
}
