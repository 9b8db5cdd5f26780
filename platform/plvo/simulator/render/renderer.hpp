// SPDX-License-Identifier: Apache-2.0
// Computes the linear radiance that reaches every pixel from the observed surface. Pixels on the rim of a
// surface use four additional rays; elsewhere the materials average their pattern over the pixel. The rows
// may be distributed over threads; the result does not depend on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/render/lightmap.hpp"
#include "plvo/simulator/render/ray_caster.hpp"
#include "plvo/simulator/scene/lighting.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

class Renderer {
 public:
  Renderer(const Scene& scene, const CameraModel& camera, int threads);

  // Renders one frame. T_world_row: T_world_camera of each row, from the top.
  void render(std::span<const Se3> T_world_row, const LightState& light);

  ImageView<const PixelHit> hits() const { return caster_.hits(); }
  ImageView<Rgb> radiance() { return {radiance_.data(), width_, height_, width_}; }
  // Irradiance of a surface that no shadow reaches.
  float irradiance(Float3 point, Float3 normal, const LightState& light) const;
  const Scene& scene() const { return scene_; }
  const RowView& view(int y) const { return caster_.view(y); }
  // Direction of each pixel's ray in the camera frame, z = 1.
  ImageView<const Float3> rays() const { return caster_.rays(); }

 private:
  void lamp_grid_rows(const LightState& light, int begin, int end);
  void lamp_fill_rows(const LightState& light, int begin, int end);
  void shade_rows(const LightState& light, int begin, int end);
  float lamp_visibility(const LightState& light, int x, int y) const;
  Rgb radiance_at(Float3 origin, Float3 direction, const Hit& hit, float footprint, const LightState& light,
                  float lamp_visible, int depth);
  Lightmap::Light unshadowed_light(Float3 point, Float3 normal) const;
  const PixelHit& seen_by(std::size_t pixel) const { return caster_.hits().data[pixel]; }
  Float3 ray(std::size_t pixel) const { return caster_.rays().data[pixel]; }
  bool on_rim(int x, int y) const;
  Rgb shade_rim(const LightState& light, int x, int y);

  const Scene& scene_;
  RayCaster caster_;
  Lightmap lightmap_;
  int width_, height_, threads_;
  int grid_width_, grid_height_;
  float pixel_angle_;             // rad, between neighbouring pixels at the centre
  std::vector<float> lamp_;       // visible share of the lamp at each pixel's point
  std::vector<float> lamp_grid_;  // the same at every kBlock-th pixel
  std::vector<Rgb> radiance_;
};

}  // namespace plvo::sim
