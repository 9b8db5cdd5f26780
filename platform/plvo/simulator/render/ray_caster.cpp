// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/render/ray_caster.hpp"

#include <cmath>

#include "plvo/simulator/parallel.hpp"

namespace plvo::sim {
RayCaster::RayCaster(const Scene& scene, const CameraModel& camera, int threads)
    : scene_(scene), width_(camera.width), height_(camera.height), threads_(threads) {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  rays_.reserve(pixels);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Vector2 ideal = undistort_pixel(camera, Vector2(x, y));
      rays_.push_back(to_float(back_project(camera.pinhole, ideal.x(), ideal.y(), 1.0)));
    }
  }
  hits_.resize(pixels);
}

void RayCaster::cast(std::span<const Se3> T_world_row) {
  views_.clear();
  for (const Se3& T : T_world_row)
    views_.push_back({to_float(T.t), to_float(T.R.col(0)), to_float(T.R.col(1)), to_float(T.R.col(2))});
  for_rows(threads_, height_, kThreadRows, [&](int a, int b) { cast_rows(a, b); });
}

void RayCaster::cast_rows(int begin, int end) {
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto i = static_cast<std::size_t>(y * width_ + x);
      const Float3 direction = view(y).to_world(rays_[i]);
      const Hit hit = scene_.closest({view(y).origin, direction}, kNear, kFar);
      PixelHit& pixel = hits_[i];
      pixel = {};
      if (hit.solid < 0) continue;
      const Solid& solid = scene_.solids[static_cast<std::size_t>(hit.solid)];
      const Float3 local = solid.to_local(view(y).origin + direction * hit.t);
      const Float3 normal = face_normal(solid, hit.face, local);
      pixel.depth_m = hit.t;  // rays have z = 1
      pixel.cosine = std::abs(dot(normal, solid.rotate_to_local(direction))) / norm(direction);
      pixel.surface = hit.surface();
    }
  }
}

}  // namespace plvo::sim
