// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/features/feature_extraction.hpp"

#include <utility>

#include "plvo/camera/observation.hpp"
#include "plvo/image/gray.hpp"
#include "plvo/image/smoothing.hpp"
#include "plvo/math/trigonometry.hpp"
#include "plvo/points/depth_mask.hpp"
#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

constexpr int kLineLevel = 1;

// The rows from begin up to, but not including, end.
ColourView rows(const ColourView& colour, int begin, int end) {
  ColourView part = colour;
  part.data += begin * colour.stride_bytes;
  part.height = end - begin;
  return part;
}
ImageView<std::uint8_t> rows(const ImageView<std::uint8_t>& image, int begin, int end) {
  return {image.row(begin), image.width, end - begin, image.stride};
}

}  // namespace

void FeatureExtraction::init(const CameraModel& camera, const Config& config) {
  camera_ = camera;
  config_ = config;
  map_.init(camera);
  pyramid_.init(camera.width, camera.height);
  segment_search_.width = pyramid_.level(kLineLevel).width;
  segment_search_.height = pyramid_.level(kLineLevel).height;
  segment_detector_[0] = SegmentDetector(segment_search_);
}

void FeatureExtraction::make_gray(const ColourView& colour, const ImageView<std::uint8_t>& gray) const {
  config_->executor.halves(
      camera_.height, [&](int begin, int end) { to_gray(rows(colour, begin, end), rows(gray, begin, end)); });
}

void FeatureExtraction::prepare_image(const ColourView& colour, Arena& scratch) {
  if (map_.active()) {
    const ScratchScope scope(scratch);
    const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
    const std::span<std::uint8_t> raw = scratch.take<std::uint8_t>("raw grey image", pixels);
    const ImageView<std::uint8_t> raw_view{raw.data(), camera_.width, camera_.height, camera_.width};
    make_gray(colour, raw_view);
    config_->executor.halves(
        camera_.height, [&](int begin, int end) { map_.undistort(raw_view, pyramid_.base(), begin, end); });
  } else {
    make_gray(colour, pyramid_.base());
  }
  pyramid_.build();
}

void FeatureExtraction::describe_points(Arena& scratch, PointFeatures& points, TrackResult& result) const {
  if (!has_points() || points.described) return;
  const StageTimer timer(*config_, result, Stage::kPoints);
  points.described = true;
  const ScratchScope scope(scratch);
  const auto pixels = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  const std::span<std::uint8_t> storage = scratch.take<std::uint8_t>("smoothed image", pixels);
  const std::span<std::uint16_t> row = take_smoothing_row(scratch, camera_.width);
  for (int level = 0; level < DetectorConfig().levels; ++level) {
    const GrayView image = pyramid_.level(level);
    const ImageView<std::uint8_t> smoothed{storage.data(), image.width, image.height, image.width};
    smooth_binomial7(image, smoothed, row);
    const Describer describe(smoothed);
    for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
      const Keypoint& keypoint = points.keypoints[i];
      if (keypoint.level == level) points.descriptors[i] = describe(keypoint.x, keypoint.y);
    }
  }
}

void FeatureExtraction::extract(const RgbdFrame& frame, const DepthSampler& depth, bool points,
                                Arena& scratch, FrameFeatures& features, TrackResult& result) {
  features.stamp_ns = frame.stamp_ns;
  {
    const StageTimer timer(*config_, result, Stage::kImage);
    prepare_image(frame.colour, scratch);
    result.mean_brightness = mean_brightness(pyramid_.level(0));
  }
  const bool lines = config_->features != Features::kPoints;
  const bool at_once = has_points() && points && lines && config_->executor;
  if (at_once) {
    const StageTimer timer(*config_, result, Stage::kPoints);
    const ScratchScope scope(scratch);
    Arena own(
        scratch.take<std::byte>("points beside segments", point_scratch(camera_.width, camera_.height)));
    config_->executor.both([&] { find_segments(scratch, features.lines, result); },
                           [&] { detect_points(depth, own, features.points, result); });
  } else if (points) {
    find_points(depth, scratch, features.points, result);
  }
  if (lines && !at_once) {
    const StageTimer timer(*config_, result, Stage::kLines);
    find_segments(scratch, features.lines, result);
  }
}

void FeatureExtraction::find_points(const DepthSampler& depth, Arena& scratch, PointFeatures& points,
                                    TrackResult& result) const {
  if (!has_points() || points.looked_for) return;
  const StageTimer timer(*config_, result, Stage::kPoints);
  detect_points(depth, scratch, points, result);
}

void FeatureExtraction::detect_points(const DepthSampler& depth, Arena& scratch, PointFeatures& points,
                                      TrackResult& result) const {
  points.looked_for = true;
  const DetectionSummary summary =
      detect_keypoints(pyramid_, depth, DetectorConfig(), scratch, points.keypoints);
  for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
    const Keypoint& keypoint = points.keypoints[i];
    points.patches[i] = cut_patch(pyramid_.level(keypoint.level), keypoint.x, keypoint.y);
  }
  result.points.with_depth =
      static_cast<int>(points.keypoints.size());  // the detector skips pixels without depth
  result.points.detected = summary.candidates;
  result.points.dropped = static_cast<int>(points.keypoints.dropped());
}

void FeatureExtraction::lift(const DepthSampler& depth, const NoiseScales& noise, Arena& scratch,
                             FrameFeatures& features) const {
  lift_points(depth, noise, features.points);
  if (config_->surfaces)
    sample_surfaces(depth, camera_.pinhole, camera_.width, camera_.height, noise.surfaces, scratch,
                    features.surfaces);
}

void FeatureExtraction::lift_points(const DepthSampler& depth_sampler, const NoiseScales& noise,
                                    PointFeatures& points) const {
  // A registered patch is a landmark by definition, whatever its centre: only its depth is uncertain. The
  // small variance across the ray keeps its covariance invertible.
  constexpr double kPatchCentre_px = 0.02;
  const PointConfig& config = config_->points;
  const double sigma_px = config.registered ? kPatchCentre_px : config.sigma_px;
  const double depth_scale = sqrt(noise.depth);
  config_->executor.halves(points.keypoints.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Keypoint& keypoint = points.keypoints[i];
      const auto u = static_cast<double>(keypoint.u);
      const auto v = static_cast<double>(keypoint.v);
      const DepthSample depth = depth_sampler.sample(u, v, config.depth_reach_px);
      // A keypoint whose window has no usable depth is placed at the camera's centre: "no 3D point".
      points.points[i] = observe_point(camera_.pinhole, u, v, depth.depth_m, sigma_px * (1 << keypoint.level),
                                       depth_scale * depth.sigma_m);
      points.masks[i] = depth.depth_m > 0
                            ? depth_mask(depth_sampler, depth.located, depth.depth_m, keypoint.level)
                            : WindowMask{};
    }
  });
}

bool FeatureExtraction::lift_line(const DepthSampler& depth, const NoiseScales& noise, const Segment& segment,
                                  Line3d& line) const {
  const Line3dReport report = observe_line(segment, depth, camera_.pinhole, config_->depth_noise,
                                           config_->lines, config_->seed, line);
  if (report.outcome != Line3dOutcome::kOk) return false;
  line.Sigma *= noise.lines;
  return true;
}

void FeatureExtraction::lift_lines(const DepthSampler& depth, const Exposure& exposure,
                                   const NoiseScales& noise, Arena& scratch, LineFeatures& lines,
                                   TrackResult& result) const {
  const StageTimer timer(*config_, result, Stage::kLines);
  if (!lines.lifted) {
    depth.fetch();
    lift_segments(depth.with(exposure), noise, scratch, lines);
    lines.lifted = true;
  } else if (exposure.depth_apart()) {
    lift_segments_again(depth.with(exposure), noise, lines);
  }
  result.lines.with_depth = static_cast<int>(lines.count_3d);
}

void FeatureExtraction::lift_segments_again(const DepthSampler& depth, const NoiseScales& noise,
                                            LineFeatures& lines) const {
  config_->executor.halves(lines.count_3d, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      (void)lift_line(depth, noise, lines.segments[i], lines.lines[i]);
  });
}

void FeatureExtraction::find_segments(Arena& scratch, LineFeatures& lines, TrackResult& result) {
  const Status status = segment_detector_[0].detect(pyramid_.level(kLineLevel), 1 << kLineLevel,
                                                    pyramid_.level(0), scratch, lines.segments);
  if (!status.ok()) lines.segments.clear();
  result.lines.detected = static_cast<int>(lines.segments.size() + lines.segments.dropped());
  result.lines.dropped = static_cast<int>(lines.segments.dropped());
}

void FeatureExtraction::lift_segments(const DepthSampler& depth, const NoiseScales& noise, Arena& scratch,
                                      LineFeatures& lines) const {
  const ScratchScope scope(scratch);
  const std::size_t n = lines.segments.size();
  const std::span<std::uint8_t> lifted = scratch.take<std::uint8_t>("segments with 3D", n);
  config_->executor.halves(lifted.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Segment& segment = lines.segments[i];
      lifted[i] = lift_line(depth, noise, segment, lines.lines[i]) ? 1 : 0;
      if (lifted[i] != 0)
        lines.descriptors[i] = describe_segment(pyramid_.level(kLineLevel), 1.0 / (1 << kLineLevel), segment);
    }
  });
  // Segments with 3D come first.
  for (std::size_t i = 0; i < lifted.size(); ++i) {
    if (lifted[i] == 0) continue;
    const std::size_t to = lines.count_3d++;
    if (to == i) continue;
    std::swap(lines.segments[i], lines.segments[to]);
    lines.lines[to] = lines.lines[i];
    lines.descriptors[to] = lines.descriptors[i];
  }
}

}  // namespace plvo
