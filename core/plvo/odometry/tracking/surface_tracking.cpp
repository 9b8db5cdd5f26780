// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/surface_tracking.hpp"

#include "plvo/surfaces/plane_window.hpp"

namespace plvo {
namespace {

constexpr double kLeastCosine = 0.9;  // between the normals
// A sample whose distance exceeds this many σ plus this share of the depth lies on another surface.
constexpr double kPlaneGateSigmas = 5;
constexpr double kPlaneGateShare = 0.01;
// SDs of the errors that all surface samples of a depth image share: the time of its exposure, and its depths
// (at 1 m, growing with the square of the depth).
constexpr double kDepthMoment_s = 0.005;
constexpr double kDepthOffset_m = 0.002;

bool match_sample(const DepthSampler& depth, const Pinhole& pinhole, double noise_scale,
                  const SurfaceSample& from, const Se3& T, SurfaceMatch& match) {
  const Exposure& exposure = depth.exposure();
  const Vector3 p = T * from.p;
  const Vector3 seen = exposure.as_seen(p);
  if (!(seen.z() > kNearestSeen_m)) return false;
  const Vector2 pixel = project(pinhole, seen);
  if (!(pixel.x() >= 0 && pixel.y() >= 0) ||
      !depth.inside(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())))
    return false;
  SurfaceSample to;
  double depth_row = 0;
  if (!observe_surface(depth, pinhole, pixel.x(), pixel.y(), noise_scale, to, seen.z(), &depth_row))
    return false;
  match.normal = T.R * from.normal;
  if (!(match.normal.dot(to.normal) > kLeastCosine)) return false;
  match.p_reference = from.p;
  match.p_current = exposure.at_mid_exposure(to.p);
  match.variance = from.variance + to.variance;
  match.normal_variance = from.normal_variance;
  const double off = match.normal.dot(p - match.p_current);
  const double limit = kPlaneGateSigmas * sqrt(match.variance) + kPlaneGateShare * p.z();
  if (!(off * off <= limit * limit)) return false;
  match.delay_s = exposure.depth_apart() ? exposure.depth_delay_s(depth_row)
                  : exposure.rolling()   ? exposure.delay_s(to.p)
                                         : 0;
  match.common.col(0) = kDepthMoment_s * exposure.rate(match.p_current);
  match.common.col(1) = (kDepthOffset_m * match.p_current.z()) * match.p_current;
  return true;
}

}  // namespace

void track_surfaces(const DepthSampler& depth, const Pinhole& pinhole, double noise_scale,
                    std::span<const SurfaceSample> reference, const Se3& T_current_reference,
                    FixedVector<SurfaceMatch>& matches) {
  matches.clear();
  SurfaceMatch match;
  for (const SurfaceSample& sample : reference)
    if (match_sample(depth, pinhole, noise_scale, sample, T_current_reference, match))
      matches.push_back(match);
}

}  // namespace plvo
