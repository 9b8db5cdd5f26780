// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/point_tracking.hpp"

#include "plvo/math/trigonometry.hpp"
#include "plvo/points/alignment.hpp"

namespace plvo {
namespace {

// The search for a first motion needs no fine registration.
constexpr AlignmentOptions kRough{.max_iterations = 5, .tolerance_px = 0.1};

// σ_p of a registered keypoint, in pixels of its level.
double registered_sigma_px(const PointConfig& config, const Alignment& alignment) {
  return sqrt(config.sigma_px * config.sigma_px + alignment.sigma_px * alignment.sigma_px);
}

// Expected pixel and depth of a keypoint in the current image.
struct Expected {
  Vector2 pixel = Vector2::Zero();
  double depth_m = DepthSampler::kUnknown;
};

// Projects the reference keypoint's 3D point after the motion. Returns false where that is out of view.
bool predict(const TrackingView& view, const Point3d& point, const Se3& T_current_reference,
             Expected& expected) {
  if (!(point.p.z() > 0)) return false;
  const Vector3 p = view.exposure.as_seen(T_current_reference * point.p);
  if (!(p.z() > kNearestSeen_m)) return false;
  const Vector2 pixel = project(view.pinhole, p);
  const GrayView image = view.pyramid.level(0);
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < image.width && pixel.y() < image.height))
    return false;
  expected = {pixel, p.z()};
  return true;
}

// Adds a track of reference keypoint i, found at `pixel`, if there is depth; expected_m as in sample().
void add_track(const TrackingView& view, std::size_t i, const Vector2& pixel, double sigma_px,
               double expected_m, PointTracks& tracks) {
  const DepthSample depth = view.depth.sample(pixel.x(), pixel.y(), view.config.depth_reach_px, expected_m);
  if (!(depth.depth_m > 0)) return;
  const std::size_t track = tracks.matches.size();
  if (!tracks.matches.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(track)})) return;
  tracks.pixels[track] = pixel;
  Point3d& point = tracks.points[track];
  point = observe_point(view.pinhole, pixel.x(), pixel.y(), depth.depth_m, sqrt(view.noise.image) * sigma_px,
                        sqrt(view.noise.depth) * depth.sigma_m);
  point.p = view.exposure.at_mid_exposure(point.p);
}

// Warp of a small patch around reference point p, which is taken to face the reference camera: the derivative
// of its projection after the motion.
PatchWarp warp_of(const Pinhole& pinhole, const Vector3& p, const Se3& T_current_reference) {
  Matrix<3, 2> facing = T_current_reference.R.block<3, 2>(0, 0);
  facing.col(0) *= p.z() / pinhole.fx;
  facing.col(1) *= p.z() / pinhole.fy;
  return {project_derivative(pinhole, T_current_reference * p) * facing};
}

// Registers the keypoint's patch around its expected position. Adds a track if the patch is found and has
// depth.
void register_keypoint(const TrackingView& view, const PointFeatures& reference, std::size_t i,
                       const Expected& expected, const AlignmentOptions& options, const PatchWarp& warp,
                       PointTracks& tracks) {
  const Keypoint& keypoint = reference.keypoints[i];
  const double scale = 1 << keypoint.level;
  // The patch is centred on a whole pixel, but the keypoint is not: the offset is kept.
  const double offset_x = static_cast<double>(keypoint.u) / scale - keypoint.x;
  const double offset_y = static_cast<double>(keypoint.v) / scale - keypoint.y;
  const Alignment alignment = align_patch(
      reference.patches[i], reference.masks[i], view.pyramid.level(keypoint.level),
      expected.pixel.x() / scale - offset_x, expected.pixel.y() / scale - offset_y, options, warp);
  if (!alignment.ok) return;
  if (!view.mask.is_free(static_cast<int>(alignment.x * scale), static_cast<int>(alignment.y * scale),
                         reach_on_base(keypoint.level, alignment.reach)))
    return;
  add_track(view, i, {(alignment.x + offset_x) * scale, (alignment.y + offset_y) * scale},
            scale * registered_sigma_px(view.config, alignment), expected.depth_m, tracks);
}

// The free capacity from `first` on.
PointTracks from(const PointTracks& tracks, std::size_t first) {
  return {FixedVector<Match>(tracks.matches.storage().subspan(first)), tracks.pixels.subspan(first),
          tracks.points.subspan(first)};
}

// Appends `later` to `tracks`. The storage of `later` begins at or behind the last of `tracks`.
void append(const PointTracks& later, PointTracks& tracks) {
  for (std::size_t i = 0; i < later.matches.size(); ++i) {
    const std::size_t track = tracks.matches.size();
    if (!tracks.matches.push_back({later.matches[i].reference, static_cast<std::uint16_t>(track)})) return;
    tracks.pixels[track] = later.pixels[i];
    tracks.points[track] = later.points[i];
  }
}

}  // namespace

void track_by_descriptor(const TrackingView& view, const PointFeatures& reference,
                         std::span<const Point3d> reference_points, const PointFeatures& current,
                         const Se3& T_current_reference, double radius_px, Arena& scratch,
                         PointTracks& tracks) {
  tracks.matches.clear();
  const ScratchScope scope(scratch);
  const std::size_t n = reference.keypoints.size();
  const std::span<Prediction> predictions = scratch.take<Prediction>("predictions", n);
  FixedVector<Match> putative(scratch.take<Match>("putative matches", n));
  if (predictions.size() < n || putative.capacity() < n) return;
  for (std::size_t i = 0; i < n; ++i) {
    Expected at;
    const bool visible = predict(view, reference_points[i], T_current_reference, at);
    predictions[i] = {static_cast<float>(at.pixel.x()), static_cast<float>(at.pixel.y()), visible};
  }

  PointMatchConfig config;
  config.radius_px = radius_px;
  const GrayView image = view.pyramid.level(0);
  match_points(reference, predictions, current, image.width, image.height, config, scratch, putative);
  for (const Match& match : putative) {
    const Keypoint& found = current.keypoints[match.current];
    const Vector2 at(static_cast<double>(found.u), static_cast<double>(found.v));
    if (view.config.registered)
      register_keypoint(view, reference, match.reference, {at}, kRough,
                        warp_of(view.pinhole, reference_points[match.reference].p, T_current_reference),
                        tracks);
    else
      add_track(view, match.reference, at, view.config.sigma_px * (1 << found.level), DepthSampler::kUnknown,
                tracks);
  }
}

void track_by_motion(const TrackingView& view, const PointFeatures& reference,
                     std::span<const Point3d> reference_points, const Se3& T_current_reference,
                     std::size_t stride, PointTracks& tracks) {
  tracks.matches.clear();
  const auto track = [&](std::size_t begin, std::size_t end, PointTracks& found) {
    found.matches.clear();
    for (std::size_t i = begin; i < end; i += stride) {
      Expected expected;
      if (!view.carried.is_carried(reference.keypoints[i]) &&
          predict(view, reference_points[i], T_current_reference, expected))
        register_keypoint(view, reference, i, expected, AlignmentOptions{},
                          warp_of(view.pinhole, reference_points[i].p, T_current_reference), found);
    }
  };
  const std::size_t n = reference.keypoints.size();
  if (!view.executor) return track(0, n, tracks);
  const std::size_t middle = n / 2 / stride * stride;
  PointTracks later = from(tracks, middle);
  view.executor.both([&] { track(0, middle, tracks); }, [&] { track(middle, n, later); });
  append(later, tracks);
}

}  // namespace plvo
