// SPDX-License-Identifier: Apache-2.0
// Computes for every pixel of a camera the surface that its ray hits, the exact depth and the angle of
// incidence. It casts one ray per pixel, through the centre. Each row has its own pose, which allows a
// rolling shutter.
#pragma once

#include <span>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

// The hit of the ray through a pixel's centre.
struct PixelHit {
  float depth_m = 0;  // along the optical axis; 0: no hit
  float cosine = 0;   // between the ray and the surface's normal, 0 … 1
  int surface = -1;   // Hit::surface(); −1: no hit
};

// Pose of one row's camera in the world.
struct RowView {
  Float3 origin;
  Float3 right, down, forward;
  Float3 to_world(Float3 v) const { return right * v.x + down * v.y + forward * v.z; }
  Float3 to_camera(Float3 v) const { return {dot(right, v), dot(down, v), dot(forward, v)}; }
};

constexpr float kNear = 1e-3F;  // m, start of the rays
constexpr float kFar = 200;     // m, end of the rays

class RayCaster {
 public:
  RayCaster(const Scene& scene, const CameraModel& camera, int threads);

  // Casts all rays. T_world_row: T_world_camera of each row, from the top.
  void cast(std::span<const Se3> T_world_row);

  ImageView<const PixelHit> hits() const { return {hits_.data(), width_, height_, width_}; }
  // Direction of each pixel's ray in the camera frame, z = 1.
  ImageView<const Float3> rays() const { return {rays_.data(), width_, height_, width_}; }
  const RowView& view(int y) const { return views_[static_cast<std::size_t>(y)]; }

 private:
  void cast_rows(int begin, int end);

  const Scene& scene_;
  int width_, height_, threads_;
  std::vector<RowView> views_;
  std::vector<Float3> rays_;
  std::vector<PixelHit> hits_;
};

}  // namespace plvo::sim
