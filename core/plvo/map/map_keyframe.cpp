// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/map_keyframe.hpp"

#include <algorithm>

#include "plvo/camera/exposure.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr double kSigmaUnit_m = 1e-4;
constexpr double kMostSigmaUnits = 65535;
// Variance along a line, where its ends are not defined.
constexpr double kAlongVariance_m2 = 1e-2;

// The two directions across the line, for each of its ends: columns 0 and 1 for a, 2 and 3 for b.
Matrix<6, 4> across_ends(const Vector3& a, const Vector3& b) {
  const Vector3 d = b - a;
  const Matrix3 frame = frame_along(d / sqrt(d.squaredNorm()));
  Matrix<6, 4> B = Matrix<6, 4>::Zero();
  B.block<3, 2>(0, 0) = frame.block<3, 2>(0, 0);
  B.block<3, 2>(3, 2) = frame.block<3, 2>(0, 0);
  return B;
}

Vector3 to_vector(const std::array<float, 3>& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

std::array<float, 3> to_floats(const Vector3& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

// A point that leaves the image stays at its border.
void move_to_mid_exposure(const Exposure& exposure, const CameraModel& camera, const Vector3& p,
                          MapPoint& point) {
  const Vector3 moved = exposure.at_mid_exposure(p);
  if (!(moved.z() > kNearestSeen_m)) return;
  const Vector2 at = project(camera.pinhole, moved);
  point.u = std::clamp(static_cast<float>(at.x()), 0.0F, static_cast<float>(camera.width - 1));
  point.v = std::clamp(static_cast<float>(at.y()), 0.0F, static_cast<float>(camera.height - 1));
  point.depth_m = static_cast<float>(moved.z());
}

}  // namespace

Point3d unpack(const MapPoint& point, const Pinhole& pinhole, double sigma_px) {
  return observe_point(pinhole, static_cast<double>(point.u), static_cast<double>(point.v),
                       static_cast<double>(point.depth_m), sigma_px * (1 << point.level),
                       kSigmaUnit_m * point.sigma_100um);
}

// The ends are rounded first, so that packing an unpacked line changes nothing.
MapLine pack(const Line3d& line) {
  MapLine packed;
  packed.a = to_floats(line.a);
  packed.b = to_floats(line.b);
  const Matrix<6, 4> B = across_ends(to_vector(packed.a), to_vector(packed.b));
  const Matrix4 C = B.transpose() * line.Sigma * B;
  std::size_t k = 0;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c <= r; ++c) packed.across[k++] = static_cast<float>(C(r, c));
  return packed;
}

Line3d unpack(const MapLine& packed) {
  Line3d line;
  line.a = to_vector(packed.a);
  line.b = to_vector(packed.b);
  const Matrix<6, 4> B = across_ends(line.a, line.b);
  Matrix4 C;
  std::size_t k = 0;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c <= r; ++c, ++k) C(r, c) = C(c, r) = static_cast<double>(packed.across[k]);
  line.Sigma = B * C * B.transpose();
  const Vector3 along = (line.b - line.a) / sqrt((line.b - line.a).squaredNorm());
  line.Sigma.block<3, 3>(0, 0) += kAlongVariance_m2 * along * along.transpose();
  line.Sigma.block<3, 3>(3, 3) += kAlongVariance_m2 * along * along.transpose();
  return line;
}

void MapFeatureStore::clear() { std::fill(counts_.begin(), counts_.end(), Counts()); }

void MapFeatureStore::set(std::size_t slot, const PointFeatures& points, const LineFeatures& lines,
                          const CameraModel& camera, const Vector6& velocity) {
  const Exposure exposure(camera, velocity, 0);
  Counts& counts = counts_[slot];
  counts = {};
  for (std::size_t i = 0; i < points.keypoints.size() && counts.points < keypoints_; ++i) {
    const Point3d& point = points.points[i];
    const Keypoint& keypoint = points.keypoints[i];
    if (!(point.p.z() > kNearestSeen_m)) continue;
    const std::size_t at = slot * keypoints_ + counts.points++;
    descriptors_[at] = points.descriptors[i];
    const double sigma = sqrt(std::max(0.0, point.Sigma(2, 2))) / kSigmaUnit_m;
    points_[at] = {keypoint.u, keypoint.v, static_cast<float>(point.p.z()),
                   static_cast<std::uint16_t>(std::clamp(sigma + 0.5, 1.0, kMostSigmaUnits)), keypoint.level};
    if (exposure.rolling()) move_to_mid_exposure(exposure, camera, point.p, points_[at]);
  }
  for (std::size_t i = 0; i < lines.count_3d && counts.lines < segments_; ++i) {
    Line3d line = lines.lines[i];
    if (!((line.b - line.a).squaredNorm() > 0)) continue;
    const std::size_t at = slot * segments_ + counts.lines++;
    line_descriptors_[at] = lines.descriptors[i];
    line.a = exposure.at_mid_exposure(line.a);
    line.b = exposure.at_mid_exposure(line.b);
    lines_[at] = pack(line);
  }
}

MapFeatures MapFeatureStore::at(std::size_t slot) const {
  const Counts& counts = counts_[slot];
  return {descriptors_.subspan(slot * keypoints_, counts.points),
          points_.subspan(slot * keypoints_, counts.points),
          line_descriptors_.subspan(slot * segments_, counts.lines),
          lines_.subspan(slot * segments_, counts.lines)};
}

}  // namespace plvo
