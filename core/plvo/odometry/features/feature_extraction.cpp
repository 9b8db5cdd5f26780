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

bool has_points(const Config& config) { return config.features != Features::kLines; }
bool has_lines(const Config& config) { return config.features != Features::kPoints; }

void lift_points(const StageContext& context, const DepthSampler& depth_sampler, PointFeatures& points) {
  // A registered patch is a landmark by definition, whatever its centre: only its depth is uncertain. The
  // small variance across the ray keeps its covariance invertible.
  constexpr double kPatchCentre_px = 0.02;
  const PointConfig& config = context.config.points;
  const double sigma_px = config.registered ? kPatchCentre_px : config.sigma_px;
  const double depth_scale = sqrt(context.noise.depth);
  context.config.executor.halves(points.keypoints.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Keypoint& keypoint = points.keypoints[i];
      const auto u = static_cast<double>(keypoint.u);
      const auto v = static_cast<double>(keypoint.v);
      const DepthSample depth = depth_sampler.sample(u, v, config.depth_reach_px);
      // A keypoint whose window has no usable depth is placed at the camera's centre: "no 3D point".
      points.points[i] = observe_point(context.camera.pinhole, u, v, depth.depth_m,
                                       sigma_px * (1 << keypoint.level), depth_scale * depth.sigma_m);
      points.masks[i] = depth.depth_m > 0
                            ? depth_mask(depth_sampler, depth.located, depth.depth_m, keypoint.level)
                            : WindowMask{};
    }
  });
}

bool lift_line(const StageContext& context, const DepthSampler& depth, const Segment& segment, Line3d& line) {
  const Config& config = context.config;
  const Line3dReport report = observe_line(segment, depth, context.camera.pinhole, config.depth_noise,
                                           config.lines, config.seed, line);
  if (report.outcome != Line3dOutcome::kOk) return false;
  line.Sigma *= context.noise.lines;
  return true;
}

// Lines are not lifted again if their depth would be read at another place by less than this.
constexpr double kSameDepth_px = 0.5;

void lift_segments_again(const StageContext& context, const DepthSampler& depth, LineFeatures& lines) {
  context.config.executor.halves(lines.count_3d, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      (void)lift_line(context, depth, lines.segments[i], lines.lines[i]);
  });
}

}  // namespace

void FeatureExtraction::init(const CameraModel& camera, GrayView mask) {
  map_.init(camera);
  mask_.init(mask, map_);
  pyramid_.init(camera.width, camera.height);
  segment_search_.width = pyramid_.level(kLineLevel).width;
  segment_search_.height = pyramid_.level(kLineLevel).height;
  segment_detector_[0] = SegmentDetector(segment_search_);
}

void FeatureExtraction::make_gray(const StageContext& context, const ColourView& colour,
                                  const ImageView<std::uint8_t>& gray) const {
  context.config.executor.halves(context.camera.height, [&](int begin, int end) {
    to_gray(rows(colour, begin, end), rows(gray, begin, end));
    mask_.blank(rows(gray, begin, end), begin);
  });
}

double FeatureExtraction::prepare_image(const StageContext& context, const ColourView& colour) {
  const StageTimer timer(context, Stage::kImage);
  const CameraModel& camera = context.camera;
  if (map_.active()) {
    const ScratchScope scope(context.scratch);
    const std::span<std::uint8_t> raw =
        context.scratch.take<std::uint8_t>("raw grey image", pixels_of(camera.width, camera.height));
    const ImageView<std::uint8_t> raw_view{raw.data(), camera.width, camera.height, camera.width};
    make_gray(context, colour, raw_view);
    context.config.executor.halves(
        camera.height, [&](int begin, int end) { map_.undistort(raw_view, pyramid_.base(), begin, end); });
  } else {
    make_gray(context, colour, pyramid_.base());
  }
  pyramid_.build();
  return mean_brightness(pyramid_.level(0), mask_);
}

void FeatureExtraction::describe_points(const StageContext& context, PointFeatures& points) const {
  if (!has_points(context.config) || points.described) return;
  const StageTimer timer(context, Stage::kPoints);
  points.described = true;
  const CameraModel& camera = context.camera;
  const ScratchScope scope(context.scratch);
  const std::span<std::uint8_t> storage =
      context.scratch.take<std::uint8_t>("smoothed image", pixels_of(camera.width, camera.height));
  const std::span<std::uint16_t> row = take_smoothing_row(context.scratch, camera.width);
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

void FeatureExtraction::detect(const StageContext& context, const DepthSampler& depth, bool with_points,
                               FrameFeatures& features) {
  const Config& config = context.config;
  Arena& scratch = context.scratch;
  if (with_points && has_points(config) && has_lines(config) && config.executor) {
    const StageTimer timer(context, Stage::kPoints);
    const ScratchScope scope(scratch);
    Arena own(scratch.take<std::byte>("points beside segments",
                                      point_scratch(context.camera.width, context.camera.height)));
    config.executor.both([&] { detect_segments(scratch, features.lines); },
                         [&] { detect_points(depth, context.carried, own, features.points); });
    return;
  }
  if (with_points) find_points(context, depth, features.points);
  if (!has_lines(config)) return;
  const StageTimer timer(context, Stage::kLines);
  detect_segments(scratch, features.lines);
}

void FeatureExtraction::find_points(const StageContext& context, const DepthSampler& depth,
                                    PointFeatures& points) const {
  if (!has_points(context.config) || points.looked_for) return;
  const StageTimer timer(context, Stage::kPoints);
  detect_points(depth, context.carried, context.scratch, points);
}

void FeatureExtraction::detect_points(const DepthSampler& depth, const CarriedCells& carried, Arena& scratch,
                                      PointFeatures& points) const {
  points.looked_for = true;
  points.candidates =
      detect_keypoints(pyramid_, depth, DetectorConfig(), scratch, points.keypoints, mask_, carried)
          .candidates;
  for (std::size_t i = 0; i < points.keypoints.size(); ++i) {
    const Keypoint& keypoint = points.keypoints[i];
    points.patches[i] = cut_patch(pyramid_.level(keypoint.level), keypoint.x, keypoint.y);
  }
}

void FeatureExtraction::detect_segments(Arena& scratch, LineFeatures& lines) {
  const Status status =
      segment_detector_[0].detect(pyramid_.level(kLineLevel), 1 << kLineLevel, pyramid_.level(0), scratch,
                                  lines.segments, nullptr, mask_);
  if (!status.ok()) lines.segments.clear();
}

void FeatureExtraction::lift(const StageContext& context, const DepthSampler& depth,
                             FrameFeatures& features) const {
  lift_points(context, depth, features.points);
  const CameraModel& camera = context.camera;
  if (context.config.surfaces)
    sample_surfaces(depth, camera.pinhole, camera.width, camera.height, context.noise.surfaces,
                    context.scratch, features.surfaces, mask_);
}

void FeatureExtraction::lift_lines(const StageContext& context, const DepthSampler& depth,
                                   const Exposure& exposure, LineFeatures& lines) const {
  const StageTimer timer(context, Stage::kLines);
  if (lines.lifts == 0) {
    depth.fetch();
    lift_segments(context, depth.with(exposure), lines);
  } else if (exposure.depth_apart() && exposure.depth_shift_px(lines.lifted_with[0]) > kSameDepth_px) {
    lift_segments_again(context, depth.with(exposure), lines);
  } else {
    return;
  }
  ++lines.lifts;
  lines.lifted_with[0] = exposure;
}

void FeatureExtraction::lift_segments(const StageContext& context, const DepthSampler& depth,
                                      LineFeatures& lines) const {
  const ScratchScope scope(context.scratch);
  const std::size_t n = lines.segments.size();
  const std::span<std::uint8_t> lifted = context.scratch.take<std::uint8_t>("segments with 3D", n);
  context.config.executor.halves(lifted.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Segment& segment = lines.segments[i];
      lifted[i] = lift_line(context, depth, segment, lines.lines[i]) ? 1 : 0;
      lines.lines[i].record = {};
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
