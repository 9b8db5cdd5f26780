// SPDX-License-Identifier: Apache-2.0
#include "plvo/c/boundary.hpp"

#include "plvo/base/arena.hpp"

namespace plvo::c {

Status too_small(const char* for_what, std::size_t needed, std::size_t bytes) {
  return Status(StatusCode::kOutOfMemory, "init needs a block of ")
      .append(static_cast<std::int64_t>(needed))
      .append(" bytes ")
      .append(for_what)
      .append(", got ")
      .append(static_cast<std::int64_t>(bytes));
}

std::span<std::byte> aligned_part(void* memory, std::size_t bytes) {
  const std::size_t beside = reinterpret_cast<std::uintptr_t>(memory) % kArenaAlignment;
  const std::size_t start = beside == 0 ? 0 : kArenaAlignment - beside;
  return {static_cast<std::byte*>(memory) + start, bytes - start};
}

CameraModel from_c(const plvo_camera& camera) {
  CameraModel model;
  model.width = camera.width;
  model.height = camera.height;
  model.pinhole = {camera.fx, camera.fy, camera.cx, camera.cy};
  const double* k = camera.distortion;
  model.distortion = {k[0], k[1], k[2], k[3], k[4]};
  model.readout_s = camera.readout_s;
  model.depth_timing = {camera.depth_timing_known != 0, camera.depth_delay_s, camera.depth_readout_s};
  return model;
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
  const double k[5] = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
  std::memcpy(camera.distortion, k, sizeof k);
  camera.readout_s = model.readout_s;
  camera.depth_delay_s = model.depth_timing.delay_s;
  camera.depth_readout_s = model.depth_timing.readout_s;
  return camera;
}

}  // namespace plvo::c
