// SPDX-License-Identifier: Apache-2.0
#include "plvo/c/boundary.hpp"

#include "plvo/base/arena.hpp"
#include "plvo/c/matrices.hpp"

namespace plvo::c {

Status too_small(const char* for_what, std::size_t needed, std::size_t bytes) {
  return Status(StatusCode::kOutOfMemory, "init needs a block of ")
      .append(static_cast<std::ptrdiff_t>(needed))
      .append(" bytes ")
      .append(for_what)
      .append(", got ")
      .append(static_cast<std::ptrdiff_t>(bytes));
}

std::span<std::byte> aligned_part(void* memory, std::size_t bytes) {
  const std::size_t beside = reinterpret_cast<std::uintptr_t>(memory) % kArenaAlignment;
  const std::size_t start = beside == 0 ? 0 : kArenaAlignment - beside;
  return {static_cast<std::byte*>(memory) + start, bytes - start};
}

Status take_camera(const plvo_camera* given, CameraModel& model) {
  plvo_camera camera = to_c(CameraModel());
  if (Status status = take_struct(given, camera, "camera"); !status.ok()) return status;
  const double* k = camera.distortion;
  const double* more = camera.distortion_more;
  if (camera.lens == PLVO_LENS_EQUIDISTANT) {
    if (k[4] != 0 || more[0] != 0 || more[1] != 0 || more[2] != 0)
      return refuse("camera.distortion of PLVO_LENS_EQUIDISTANT is k1 k2 k3 k4; the others must be 0");
    model.distortion = {.k1 = k[0], .k2 = k[1], .k3 = k[2], .k4 = k[3], .model = LensModel::kEquidistant};
  } else if (camera.lens == PLVO_LENS_RATIONAL) {
    model.distortion = {k[0], k[1], k[2], k[3], k[4], more[0], more[1], more[2]};
  } else {
    return refuse("camera.lens must be PLVO_LENS_RATIONAL or PLVO_LENS_EQUIDISTANT");
  }
  model.width = camera.width;
  model.height = camera.height;
  model.pinhole = {camera.fx, camera.fy, camera.cx, camera.cy};
  model.readout_s = camera.readout_s;
  model.depth_timing = {camera.depth_timing_known != 0, camera.depth_delay_s, camera.depth_readout_s};
  model.stamp_sigma_s = camera.stamp_sigma_s;
  return {};
}

plvo_camera to_c(const CameraModel& model) {
  plvo_camera camera;
  std::memset(&camera, 0, sizeof camera);
  camera.struct_size = sizeof camera;
  camera.width = model.width;
  camera.height = model.height;
  camera.depth_timing_known = model.depth_timing.known ? 1 : 0;
  camera.fx = model.pinhole.fx;
  camera.fy = model.pinhole.fy;
  camera.cx = model.pinhole.cx;
  camera.cy = model.pinhole.cy;
  const Distortion& lens = model.distortion;
  const bool fisheye = lens.model == LensModel::kEquidistant;
  camera.lens = fisheye ? PLVO_LENS_EQUIDISTANT : PLVO_LENS_RATIONAL;
  const double rational[8] = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, lens.k4, lens.k5, lens.k6};
  const double equidistant[8] = {lens.k1, lens.k2, lens.k3, lens.k4};
  const double* k = fisheye ? equidistant : rational;
  std::memcpy(camera.distortion, k, sizeof camera.distortion);
  std::memcpy(camera.distortion_more, k + 5, sizeof camera.distortion_more);
  camera.readout_s = model.readout_s;
  camera.depth_delay_s = model.depth_timing.delay_s;
  camera.depth_readout_s = model.depth_timing.readout_s;
  camera.stamp_sigma_s = model.stamp_sigma_s;
  return camera;
}

Status give_camera(const plvo_camera& whole, plvo_camera* caller) {
  const bool older = caller->struct_size < offsetof(plvo_camera, stamp_sigma_s);
  const double* more = whole.distortion_more;
  if (older && (whole.lens != PLVO_LENS_RATIONAL || more[0] != 0 || more[1] != 0 || more[2] != 0))
    return refuse(
        "this camera's lens has more coefficients than camera.struct_size has room for: compile the program "
        "for "
        "this plvo, which sets it to sizeof(plvo_camera)");
  give_struct(whole, caller);
  return {};
}

Status take_result(const plvo_result* given, TrackResult& result) {
  plvo_result whole;
  std::memset(&whole, 0, sizeof whole);
  if (Status status = take_struct(given, whole, "result"); !status.ok()) return status;
  if (whole.state < PLVO_INITIALISING || whole.state > PLVO_PREDICTED)
    return refuse("result: state must be one of PLVO_TRACKING …");
  result.state = static_cast<TrackState>(whole.state);
  result.stamp_ns = whole.stamp_ns;
  result.reference_stamp_ns = whole.reference_stamp_ns;
  result.T_world_camera = se3(whole.T_world_camera);
  result.pose_covariance = matrix<6>(whole.pose_covariance);
  result.T_camera_reference = se3(whole.T_camera_reference);
  result.motion_covariance = matrix<6>(whole.motion_covariance);
  result.world = whole.world;
  result.restarted = whole.restarted != 0;
  return {};
}

}  // namespace plvo::c
