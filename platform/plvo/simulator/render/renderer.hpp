// SPDX-License-Identifier: Apache-2.0
// Ray casting of a room: what every pixel sees (surface, exact depth, angle of incidence) and the linear
// radiance that reaches it. One ray per pixel through its centre; pixels on the rim of a surface take four
// more, the rest is averaged by the materials themselves. Work is cut into rows and may be shared by threads;
// no result depends on how.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/render/lightmap.hpp"
#include "plvo/simulator/scene/lighting.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

// What the ray through a pixel's centre meets.
struct PixelHit {
  float depth_m = 0;  // along the optical axis; 0: nothing
  float cosine = 0;   // between the ray and the surface's normal, 0 … 1
  int surface = -1;   // Hit::surface(); −1: nothing
};

class Renderer {
 public:
  Renderer(const Scene& scene, const CameraModel& camera, int threads);

  void render(const Se3& T_world_camera, const LightState& light);
  // With a rolling shutter: T_world_camera of each row, from the top.
  void render(std::span<const Se3> T_world_row, const LightState& light);

  ImageView<const PixelHit> hits() const { return {hits_.data(), width_, height_, width_}; }
  ImageView<Rgb> radiance() { return {radiance_.data(), width_, height_, width_}; }
  // Direction of each pixel's ray in the camera frame, z = 1.
  ImageView<const Float3> rays() const { return {rays_.data(), width_, height_, width_}; }

 private:
  struct View {
    Float3 origin;
    Float3 right, down, forward;
    Float3 to_world(Float3 v) const { return right * v.x + down * v.y + forward * v.z; }
  };

  void trace_rows(int begin, int end);
  void lamp_grid_rows(const LightState& light, int begin, int end);
  void lamp_fill_rows(const LightState& light, int begin, int end);
  void shade_rows(const LightState& light, int begin, int end);
  float lamp_visibility(const LightState& light, int x, int y) const;
  Rgb radiance_at(Float3 origin, Float3 direction, const Hit& hit, float footprint, const LightState& light,
                  float lamp_visible, int depth);
  const View& view(int y) const { return views_[static_cast<std::size_t>(y)]; }
  bool on_rim(int x, int y) const;
  Rgb shade_rim(const LightState& light, int x, int y);

  const Scene& scene_;
  Lightmap lightmap_;
  int width_, height_, threads_;
  int grid_width_, grid_height_;
  float pixel_angle_;        // rad, between neighbouring pixels at the centre
  std::vector<View> views_;  // of each row
  std::vector<Float3> rays_;
  std::vector<PixelHit> hits_;
  std::vector<float> lamp_;       // share of the lamp that each pixel's point sees
  std::vector<float> lamp_grid_;  // the same at every kBlock-th pixel
  std::vector<Rgb> radiance_;
};

}  // namespace plvo::sim
