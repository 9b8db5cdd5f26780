// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/feature_extraction.hpp"

#include "plvo/camera/observation.hpp"
#include "plvo/image/gray.hpp"
#include "plvo/image/smoothing.hpp"
#include "plvo/points/descriptor.hpp"

namespace plvo {

void FeatureExtraction::init(const CameraModel& camera, const Config& config) {
  camera_ = camera;
  config_ = config;
  table_.init(camera);
  pyramid_.init(camera.width, camera.height);
}

void FeatureExtraction::prepare_image(const ColourView& colour, Arena& scratch) {
  if (table_.active()) {
    const ScratchScope scope(scratch);
    const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
    const std::span<std::uint8_t> raw = scratch.take<std::uint8_t>("raw grey image", pixels);
    const ImageView<std::uint8_t> raw_view{raw.data(), camera_.width, camera_.height, camera_.width};
    to_gray(colour, raw_view);
    table_.undistort(raw_view, pyramid_.base());
  } else {
    to_gray(colour, pyramid_.base());
  }
  pyramid_.build();
}

void FeatureExtraction::describe_points(Arena& scratch, PointFeatures& points) {
  const ScratchScope scope(scratch);
  const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  const std::span<std::uint8_t> storage = scratch.take<std::uint8_t>("smoothed image", pixels);
  const std::span<std::uint16_t> row = take_smoothing_row(scratch, camera_.width);
  for (int level = 0; level < config_.points.pyramid_levels; ++level) {
    const GrayView image = pyramid_.level(level);
    const ImageView<std::uint8_t> smoothed{storage.data(), image.width, image.height, image.width};
    smooth_binomial7(image, smoothed, row);
    for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
      const Keypoint& keypoint = points.keypoints[i];
      if (keypoint.level != level) continue;
      points.descriptors[i] = describe(smoothed, keypoint.x, keypoint.y);
      points.patches[i] = cut_patch(image, keypoint.x, keypoint.y);
    }
  }
}

void FeatureExtraction::extract(const RgbdFrame& frame, const DepthSampler& depth, Arena& scratch,
                                FrameFeatures& features, TrackResult& result) {
  features.stamp_ns = frame.stamp_ns;
  {
    const StageTimer timer(config_.stage_clock, result, Stage::kImage);
    prepare_image(frame.colour, scratch);
    result.mean_brightness = mean_brightness(pyramid_.level(0));
  }
  const StageTimer timer(config_.stage_clock, result, Stage::kPoints);
  PointFeatures& points = features.points;
  DetectorOptions options;
  options.levels = config_.points.pyramid_levels;
  options.cell_px = config_.points.cell_px;
  options.noise_floor = config_.points.noise_floor;
  options.min_strength = config_.points.min_strength;
  const DetectionSummary summary = detect_keypoints(pyramid_, depth, options, scratch, points.keypoints);
  describe_points(scratch, points);
  lift_points(depth, points, result);

  result.points.detected = summary.candidates;
  result.points.dropped = static_cast<int>(points.keypoints.dropped());
}

void FeatureExtraction::lift_points(const DepthSampler& depth_sampler, PointFeatures& points,
                                    TrackResult& result) const {
  // P2, P3. A keypoint whose window turns out to have no usable depth keeps a covariance of zero: "no 3D
  // point".
  int with_depth = 0;
  for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
    const Keypoint& keypoint = points.keypoints[i];
    const DepthSample depth = depth_sampler.sample(keypoint.u, keypoint.v);
    points.points[i] =
        observe_keypoint(camera_.pinhole, config_.points, keypoint.level, keypoint.u, keypoint.v, depth);
    with_depth += depth.depth_m > 0 ? 1 : 0;
  }
  result.points.with_depth = with_depth;
}

Point3d observe_keypoint(const Pinhole& pinhole, const PointConfig& config, int level, double u, double v,
                         const DepthSample& depth) {
  return observe_point(pinhole, u, v, depth.depth_m, config.sigma_px * (1 << level), depth.sigma_m);
}

}  // namespace plvo
