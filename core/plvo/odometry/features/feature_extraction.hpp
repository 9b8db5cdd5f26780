// SPDX-License-Identifier: Apache-2.0
// Figure 1, boxes P1–P3 and L1–L3: from the two images of a frame to features with 3D positions and
// covariances.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/image/undistortion.hpp"
#include "plvo/lines/lsd/lsd.hpp"
#include "plvo/odometry/features/frame_features.hpp"
#include "plvo/odometry/stage_context.hpp"
#include "plvo/points/detector.hpp"
#include "plvo/surfaces/surface_sampling.hpp"

namespace plvo {

class FeatureExtraction {
 public:
  constexpr void allocate(Arena& memory, const Limits& limits) {
    map_.allocate(memory, limits.width, limits.height);
    pyramid_.allocate(memory, limits.width, limits.height);
    if (limits.mask) mask_.allocate(memory, limits.width, limits.height);
    segment_search_ = segment_search(limits);
    segment_detector_ = memory.take<SegmentDetector>("segment detector", 1);
  }
  // Reserves the scratch. The stages run one after the other, so the largest counts; on two cores the points
  // have their own.
  static constexpr void reserve(Arena& memory, const Limits& limits) {
    {
      const ScratchScope scope(memory);
      memory.take<std::uint8_t>("raw grey image", pixels_of(limits.width, limits.height));
    }
    reserve_detection(memory, limits.width, limits.height);
    {
      const ScratchScope scope(memory);
      memory.take<std::uint8_t>("smoothed image", pixels_of(limits.width, limits.height));
      take_smoothing_row(memory, limits.width);
    }
    {
      const ScratchScope scope(memory);
      if (limits.cores > 1)
        memory.take<std::byte>("points beside segments", point_scratch(limits.width, limits.height));
      memory.take<std::byte>("segment detection", SegmentDetector::scratch_bytes(segment_search(limits)));
    }
    reserve_surface_sampling(memory, limits.width, limits.height, limits.surfaces);
    {
      const ScratchScope scope(memory);
      memory.take<std::uint8_t>("segments with 3D", static_cast<std::size_t>(limits.segments));
    }
  }

  // Builds the tables of this camera. mask: as in Config, of its size.
  void init(const CameraModel& camera, GrayView mask = {});

  // Returns a sampler of the frame's own depth; it is valid as long as the frame's views, and with a mask
  // until the next one is made.
  DepthSampler depth_sampler(const RgbdFrame& frame, const DepthNoise& noise) const {
    return {mask_.active() ? mask_.without_masked(frame.depth) : frame.depth, map_, noise};
  }

  // Makes the grey, undistorted pyramid of a colour image, whose size was checked. All functions below work
  // on it. Returns the mean brightness.
  double prepare_image(const StageContext& context, const ColourView& colour);
  // Finds the segments (L1) and, if `with_points`, the keypoints (P1). They have no 3D positions
  // yet.
  void detect(const StageContext& context, const DepthSampler& depth, bool with_points,
              FrameFeatures& features);
  // Finds the keypoints (P1), unless they were searched before.
  void find_points(const StageContext& context, const DepthSampler& depth, PointFeatures& points) const;
  // Computes the descriptors of the keypoints, for matching (P4), unless they were computed before.
  void describe_points(const StageContext& context, PointFeatures& points) const;
  // Computes what a reference needs besides lines: P2 and P3 with the depth mask of each keypoint, and
  // samples of surfaces. Call it when the best estimate of the motion during the exposure is known.
  void lift(const StageContext& context, const DepthSampler& depth, FrameFeatures& features) const;
  // Lifts the segments to 3D lines (L2, L3), given the motion during the exposure. The segments
  // that get 3D move to the front and are described. A second call, with a better motion, lifts
  // these again if depth and colour have different exposures; a segment that cannot be lifted again
  // keeps its old line.
  void lift_lines(const StageContext& context, const DepthSampler& depth, const Exposure& exposure,
                  LineFeatures& lines) const;

  // Image of the last frame, which matching registers against.
  const Pyramid& pyramid() const { return pyramid_; }
  const ImageMask& mask() const { return mask_; }

 private:
  // Segments are searched at half the resolution. With several bands, the number of candidates is bounded as
  // well.
  static constexpr SegmentSearch segment_search(const Limits& limits) {
    SegmentSearch search{(limits.width + 1) / 2, (limits.height + 1) / 2, limits.line_bands};
    if (limits.line_bands > 1) search.most_candidates = 8 * static_cast<std::size_t>(limits.segments);
    return search;
  }
  static constexpr std::size_t pixels_of(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  // Bytes of an arena that holds what reserve_detection counts, whatever its alignment.
  static constexpr std::size_t point_scratch(int width, int height) {
    Arena sizer = Arena::counting();
    reserve_detection(sizer, width, height);
    return sizer.peak() + kArenaAlignment;
  }
  void make_gray(const StageContext& context, const ColourView& colour,
                 const ImageView<std::uint8_t>& gray) const;
  void detect_points(const DepthSampler& depth, const CarriedCells& carried, Arena& scratch,
                     PointFeatures& points) const;
  void detect_segments(Arena& scratch, LineFeatures& lines);
  void lift_segments(const StageContext& context, const DepthSampler& depth, LineFeatures& lines) const;

  UndistortionMap map_;
  Pyramid pyramid_;
  ImageMask mask_;
  SegmentSearch segment_search_;
  std::span<SegmentDetector> segment_detector_;  // size 1
};

}  // namespace plvo
