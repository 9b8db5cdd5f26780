// SPDX-License-Identifier: Apache-2.0
// What the map keeps of the features of its keyframes: the descriptors, and the 3D points and lines with
// their covariances in fewer bytes. A point's covariance (4) follows from its pixel, its depth and two
// standard deviations. A line's covariance is kept across the line, where it constrains a motion. Two views
// of one place are seldom seen with the same velocity, so the effect of a rolling shutter is removed first.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/lines/line_features.hpp"
#include "plvo/map/map_limits.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

struct MapPoint {
  float u = 0, v = 0;             // level-0 pixels
  float depth_m = 0;              // along z
  std::uint16_t sigma_100um = 0;  // standard deviation of the depth, in 0.1 mm
  std::uint8_t level = 0;         // of the pyramid
};

struct MapLine {
  std::array<float, 3> a{}, b{};   // ends, camera frame, m
  std::array<float, 10> across{};  // covariance of both ends across the line: lower triangle of 4×4, m²
};

// The features of one keyframe; spans into the store.
struct MapFeatures {
  std::span<Descriptor> descriptors;
  std::span<MapPoint> points;
  std::span<LineDescriptor> line_descriptors;
  std::span<MapLine> lines;
};

class MapFeatureStore {
 public:
  constexpr void allocate(Arena& memory, const MapLimits& limits) {
    keypoints_ = static_cast<std::size_t>(limits.keypoints);
    segments_ = static_cast<std::size_t>(limits.segments);
    const auto n = static_cast<std::size_t>(limits.keyframes);
    descriptors_ = memory.take<Descriptor>("map points", n * keypoints_);
    points_ = memory.take<MapPoint>("map points", n * keypoints_);
    line_descriptors_ = memory.take<LineDescriptor>("map lines", n * segments_);
    lines_ = memory.take<MapLine>("map lines", n * segments_);
    counts_ = memory.take<Counts>("map points", n);
  }
  // Forgets all features.
  void clear();

  // Writes the features of a keyframe; those beyond the capacity, and points without depth, are left out. The
  // velocity is that of the scene, as in exposure.hpp. With a rolling shutter, it moves the features to where
  // they are when the middle row is exposed. How many there are does not depend on it.
  void set(std::size_t slot, const PointFeatures& points, const LineFeatures& lines,
           const CameraModel& camera, const Vector6& velocity);
  MapFeatures at(std::size_t slot) const;
  // Room for features that the caller writes; no more than keypoints() and segments().
  MapFeatures make_room(std::size_t slot, std::uint16_t points, std::uint16_t lines) {
    counts_[slot] = {points, lines};
    return at(slot);
  }
  // Those of slot s begin at s · keypoints().
  std::span<const Descriptor> all_descriptors() const { return descriptors_; }

  std::size_t keypoints() const { return keypoints_; }
  std::size_t segments() const { return segments_; }

 private:
  struct Counts {
    std::uint16_t points = 0, lines = 0;
  };
  std::size_t keypoints_ = 0, segments_ = 0;
  std::span<Descriptor> descriptors_;
  std::span<MapPoint> points_;
  std::span<LineDescriptor> line_descriptors_;
  std::span<MapLine> lines_;
  std::span<Counts> counts_;
};

// The measurements as the estimator takes them. sigma_px: standard deviation of a detected keypoint, in
// pixels of its level.
Point3d unpack(const MapPoint& point, const Pinhole& pinhole, double sigma_px);
Line3d unpack(const MapLine& line);
MapLine pack(const Line3d& line);

}  // namespace plvo
