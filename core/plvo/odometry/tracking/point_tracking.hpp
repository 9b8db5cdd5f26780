// SPDX-License-Identifier: Apache-2.0
// Finds the reference's keypoints in the current frame and lifts them to 3D, in two ways. Descriptors need no
// good prediction and serve to find a first motion. With a good motion, the patch of every reference keypoint
// is registered at its predicted position. Registration does not depend on the detector finding the same
// corner again, so it yields several times as many matches.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/image/depth_sampler.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/odometry/config.hpp"
#include "plvo/points/carried_cells.hpp"
#include "plvo/points/keypoint.hpp"
#include "plvo/points/point_match.hpp"

namespace plvo {

// Tracks: reference keypoint matches[i].reference was found at pixels[i] and has the 3D point points[i]
// there; matches[i].current is i.
struct PointTracks {
  FixedVector<Match> matches;
  std::span<Vector2> pixels;  // level-0 px
  std::span<Point3d> points;  // camera frame of the current frame, at mid-exposure
};

// The parts of the current frame that the tracker needs.
struct TrackingView {
  const Pinhole& pinhole;
  const PointConfig& config;
  const Pyramid& pyramid;
  const ImageMask& mask;
  const DepthSampler& depth;
  const Exposure& exposure;
  const NoiseScales& noise;
  const Executor& executor;
  const CarriedCells& carried;
};

// Tracks by descriptors, within radius_px of the positions that T_current_reference predicts for the
// reference keypoints. With registration, matches are then registered roughly; without, they lie where the
// current frame's detector put them. reference_points: those of the reference's keypoints, at its
// mid-exposure.
void track_by_descriptor(const TrackingView& view, const PointFeatures& reference,
                         std::span<const Point3d> reference_points, const PointFeatures& current,
                         const Se3& T_current_reference, double radius_px, Arena& scratch,
                         PointTracks& tracks);

// Tracks every stride-th keypoint by registration alone, from the positions that T_current_reference
// predicts.
void track_by_motion(const TrackingView& view, const PointFeatures& reference,
                     std::span<const Point3d> reference_points, const Se3& T_current_reference,
                     std::size_t stride, PointTracks& tracks);

// Reserves the scratch of track_by_descriptor.
constexpr void reserve_tracking(Arena& memory, int keypoints, int width, int height) {
  const ScratchScope scope(memory);
  const auto n = static_cast<std::size_t>(keypoints);
  memory.take<Prediction>("predictions", n);
  memory.take<Match>("putative matches", n);
  reserve_point_match(memory, keypoints, width, height);
}

}  // namespace plvo
