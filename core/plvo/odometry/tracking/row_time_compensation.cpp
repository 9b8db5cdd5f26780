// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/row_time_compensation.hpp"

namespace plvo {
namespace {

// Mean velocity since the last good frame, given this motion from the reference.
Velocity recent_velocity(const PairTiming& timing, const Se3& T_current_reference) {
  if (timing.recent) return {*timing.recent, timing.since_last_ns};
  if (!(timing.since_last_ns > 0)) return {};
  return {mean_velocity(T_current_reference * timing.T_reference_last,
                        static_cast<double>(timing.since_last_ns) * 1e-9),
          timing.since_last_ns};
}

Vector6 reference_velocity(const PairTiming& timing, const Velocity& recent) {
  if (timing.reference.known() && !timing.reference_is_last) return timing.reference.value;
  return velocity_between(timing.reference, recent);
}

Exposure reference_exposure(const CameraModel& camera, const PairTiming& timing,
                            const Se3& T_current_reference) {
  return {camera, reference_velocity(timing, recent_velocity(timing, T_current_reference)), 0};
}

std::span<const Line3d> carried(const Exposure& exposure, std::span<const Line3d> lines, Arena& scratch) {
  const std::span<Line3d> copies = scratch.take<Line3d>("at mid-exposure", lines.size());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    copies[i] = lines[i];
    copies[i].a = exposure.at_mid_exposure(lines[i].a);
    copies[i].b = exposure.at_mid_exposure(lines[i].b);
  }
  return copies;
}

std::span<const SurfaceSample> carried(const Exposure& exposure, std::span<const SurfaceSample> samples,
                                       Arena& scratch) {
  if (samples.empty()) return samples;
  const std::span<SurfaceSample> copies = scratch.take<SurfaceSample>("at mid-exposure", samples.size());
  for (std::size_t i = 0; i < copies.size(); ++i) {
    copies[i] = samples[i];
    copies[i].p = exposure.at_mid_exposure(samples[i].p);
  }
  return copies;
}

}  // namespace

Exposure current_exposure(const CameraModel& camera, const PairTiming& timing,
                          const Se3& T_current_reference) {
  const Velocity recent = recent_velocity(timing, T_current_reference);
  return {camera, velocity_at_exposure(recent, timing.last), timing.depth_after_colour_s};
}

RowTimeCompensation compensate_row_times_of_points(const CameraModel& camera, const PairTiming& timing,
                                                   const Se3& T_current_reference,
                                                   const FrameFeatures& reference, Arena& scratch) {
  RowTimeCompensation result;
  const std::span<const Point3d> points = reference.points.points.first(reference.points.keypoints.size());
  result.reference_points = points;
  result.current_exposure = current_exposure(camera, timing, T_current_reference);
  if (!(camera.readout_s > 0)) return result;

  const Exposure exposure = reference_exposure(camera, timing, T_current_reference);
  const std::span<Point3d> copies = scratch.take<Point3d>("at mid-exposure", points.size());
  for (std::size_t i = 0; i < copies.size(); ++i)
    copies[i] = {exposure.at_mid_exposure(points[i].p), points[i].Sigma, points[i].record};
  result.reference_points = copies;
  return result;
}

RowTimeCompensation compensate_row_times(const CameraModel& camera, const PairTiming& timing,
                                         const Se3& T_current_reference, const FrameFeatures& reference,
                                         const FrameFeatures& current, Arena& scratch) {
  RowTimeCompensation result =
      compensate_row_times_of_points(camera, timing, T_current_reference, reference, scratch);
  result.reference_lines = reference.lines.lines_3d();
  result.current_lines = current.lines.lines_3d();
  result.reference_surfaces = reference.surfaces.samples.span();
  if (!(camera.readout_s > 0)) return result;

  const Exposure exposure = reference_exposure(camera, timing, T_current_reference);
  result.reference_lines = carried(exposure, reference.lines.lines_3d(), scratch);
  result.current_lines = carried(result.current_exposure, current.lines.lines_3d(), scratch);
  result.reference_surfaces = carried(exposure, result.reference_surfaces, scratch);
  return result;
}

}  // namespace plvo
