// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/feature_extraction.hpp"

#include <utility>

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
  segment_detector_[0] = SegmentDetector((camera.width + 1) / 2, (camera.height + 1) / 2);
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
    const Describer describe(smoothed);
    for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
      const Keypoint& keypoint = points.keypoints[i];
      if (keypoint.level != level) continue;
      points.descriptors[i] = describe(keypoint.x, keypoint.y);
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
  features.points.keypoints.clear();
  features.lines.segments.clear();
  features.lines.count_3d = 0;
  if (config_.features != Features::kLines) extract_points(depth, scratch, features.points, result);
  if (config_.features != Features::kPoints) extract_lines(depth, scratch, features.lines, result);
}

void FeatureExtraction::extract_points(const DepthSampler& depth, Arena& scratch, PointFeatures& points,
                                       TrackResult& result) {
  const StageTimer timer(config_.stage_clock, result, Stage::kPoints);
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
    points.points[i] = observe_point(camera_.pinhole, keypoint.u, keypoint.v, depth.depth_m,
                                     config_.points.sigma_px * (1 << keypoint.level), depth.sigma_m);
    with_depth += depth.depth_m > 0 ? 1 : 0;
  }
  result.points.with_depth = with_depth;
}

void FeatureExtraction::extract_lines(const DepthSampler& depth, Arena& scratch, LineFeatures& lines,
                                      TrackResult& result) {
  const StageTimer timer(config_.stage_clock, result, Stage::kLines);
  constexpr int kLevel = 1;
  constexpr double kScale = 1 << kLevel;
  const GrayView reduced = pyramid_.level(kLevel);
  const Status status =
      segment_detector_[0].detect(reduced, kScale, pyramid_.level(0), scratch, lines.segments);
  if (!status.ok()) lines.segments.clear();
  result.lines.detected = static_cast<int>(lines.segments.size() + lines.segments.dropped());
  result.lines.dropped = static_cast<int>(lines.segments.dropped());

  for (std::size_t i = 0; i < lines.segments.size(); ++i) {
    const Segment segment = lines.segments[i];
    Line3d& line = lines.lines[lines.count_3d];
    if (observe_line(segment, depth, camera_.pinhole, config_.depth_noise, config_.lines.fit, line).outcome !=
        Line3dOutcome::kOk)
      continue;
    std::swap(lines.segments[i], lines.segments[lines.count_3d]);
    lines.descriptors[lines.count_3d] = describe_segment(reduced, 1 / kScale, segment);
    ++lines.count_3d;
  }
  result.lines.with_depth = static_cast<int>(lines.count_3d);
}

}  // namespace plvo
