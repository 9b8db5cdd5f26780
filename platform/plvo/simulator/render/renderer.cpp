// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plvo/simulator/parallel.hpp"

namespace plvo::sim {
namespace {

constexpr int kBlock = 4;          // px, spacing of the points at which the lamp's shadow is sampled first
constexpr int kLampEdge = 3;       // 3 × 3 shadow rays to the lamp
constexpr float kPenumbra = 0.3F;  // a block whose corners differ by less than this is interpolated
static_assert(kThreadRows % kBlock == 0);
constexpr float kReflectiveGloss = 0.25F;  // below this gloss no mirror image is traced
// Four sub-pixel samples that differ in both coordinates (a rotated grid).
constexpr std::array<std::array<float, 2>, 4> kRimSamples = {
    {{-0.125F, -0.375F}, {0.375F, -0.125F}, {-0.375F, 0.125F}, {0.125F, 0.375F}}};

}  // namespace

Renderer::Renderer(const Scene& scene, const CameraModel& camera, int threads)
    : scene_(scene),
      caster_(scene, camera, threads),
      lightmap_(scene),
      width_(camera.width),
      height_(camera.height),
      threads_(threads),
      grid_width_((camera.width - 1) / kBlock + 2),
      grid_height_((camera.height - 1) / kBlock + 2),
      pixel_angle_(static_cast<float>(1 / camera.pinhole.fx)) {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  lamp_.resize(pixels);
  radiance_.resize(pixels);
  lamp_grid_.resize(static_cast<std::size_t>(grid_width_) * static_cast<std::size_t>(grid_height_));
}

void Renderer::render(std::span<const Se3> T_world_row, const LightState& light) {
  caster_.cast(T_world_row);
  if (light.lamp_on) {
    for_rows(threads_, grid_height_, 4, [&](int a, int b) { lamp_grid_rows(light, a, b); });
    for_rows(threads_, height_, kThreadRows, [&](int a, int b) { lamp_fill_rows(light, a, b); });
  }
  for_rows(threads_, height_, kThreadRows, [&](int a, int b) { shade_rows(light, a, b); });
}

float Renderer::lamp_visibility(const LightState& light, int x, int y) const {
  const auto i = static_cast<std::size_t>(y * width_ + x);
  const PixelHit& pixel = seen_by(i);
  if (pixel.surface < 0) return 0;
  const Float3 point = view(y).origin + view(y).to_world(ray(i)) * pixel.depth_m;
  const Solid& solid = scene_.solids[static_cast<std::size_t>(pixel.surface / Solid::kFaces)];
  const Float3 normal =
      solid.rotate_to_world(face_normal(solid, pixel.surface % Solid::kFaces, solid.to_local(point)));
  const Float3 origin = point + normal * kLift;
  // The surface faces away from the lamp or lies behind it: it receives no light, so occlusion does not
  // matter.
  if (dot(normal, light.lamp.centre - origin) <= 0 || dot(light.lamp.normal, origin - light.lamp.centre) <= 0)
    return 1;
  const auto sees = [&](int u, int v) {
    const Float3 target = light.lamp.centre +
                          light.lamp.half_u * (static_cast<float>(2 * u + 1) / kLampEdge - 1) +
                          light.lamp.half_v * (static_cast<float>(2 * v + 1) / kLampEdge - 1);
    return scene_.occluded({origin, target - origin}, 0, 0.999F) ? 0 : 1;
  };
  // If the corners and the centre of the lamp agree, they decide for all samples.
  constexpr int kLast = kLampEdge - 1;
  constexpr int kMiddle = kLampEdge / 2;
  const int outline =
      sees(0, 0) + sees(kLast, 0) + sees(0, kLast) + sees(kLast, kLast) + sees(kMiddle, kMiddle);
  if (outline == 0 || outline == 5) return static_cast<float>(outline / 5);
  const int edges = sees(kMiddle, 0) + sees(0, kMiddle) + sees(kLast, kMiddle) + sees(kMiddle, kLast);
  return static_cast<float>(outline + edges) / (kLampEdge * kLampEdge);
}

void Renderer::lamp_grid_rows(const LightState& light, int begin, int end) {
  for (int gy = begin; gy < end; ++gy) {
    for (int gx = 0; gx < grid_width_; ++gx)
      lamp_grid_[static_cast<std::size_t>(gy * grid_width_ + gx)] =
          lamp_visibility(light, std::min(gx * kBlock, width_ - 1), std::min(gy * kBlock, height_ - 1));
  }
}

// A pixel interpolates the lamp visibility of those corners of its block that lie on the same surface, if
// they agree. At the rims of shadows and of surfaces every pixel is traced.
void Renderer::lamp_fill_rows(const LightState& light, int begin, int end) {
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto i = static_cast<std::size_t>(y * width_ + x);
      const int surface = seen_by(i).surface;
      const int gx = x / kBlock;
      const int gy = y / kBlock;
      std::array<float, 4> corner{};
      int same = 0;
      float lowest = 2;
      float highest = -1;
      for (int k = 0; k < 4; ++k) {
        const int cx = gx + (k & 1);
        const int cy = gy + (k >> 1);
        const int px = std::min(cx * kBlock, width_ - 1);
        const int py = std::min(cy * kBlock, height_ - 1);
        corner[static_cast<std::size_t>(k)] = lamp_grid_[static_cast<std::size_t>(cy * grid_width_ + cx)];
        if (seen_by(static_cast<std::size_t>(py * width_ + px)).surface != surface) continue;
        ++same;
        lowest = std::min(lowest, corner[static_cast<std::size_t>(k)]);
        highest = std::max(highest, corner[static_cast<std::size_t>(k)]);
      }
      if (same == 4 && highest - lowest < kPenumbra) {
        const float u = static_cast<float>(x - gx * kBlock) / kBlock;
        const float v = static_cast<float>(y - gy * kBlock) / kBlock;
        lamp_[i] = mix(mix(corner[0], corner[1], u), mix(corner[2], corner[3], u), v);
      } else if (same > 0 && highest == lowest) {
        lamp_[i] = lowest;
      } else {
        lamp_[i] = lamp_visibility(light, x, y);
      }
    }
  }
}

Lightmap::Light Renderer::unshadowed_light(Float3 point, Float3 normal) const {
  Lightmap::Light sum{0, 1};
  for (const PanelLight& panel : scene_.lights)
    sum.direct += panel_irradiance(scene_.bvh, panel, point, normal, 1, false);
  return sum;
}

float Renderer::irradiance(Float3 point, Float3 normal, const LightState& light) const {
  float sum = light.ceiling * (unshadowed_light(point, normal).direct + scene_.ambient);
  if (light.lamp_on)
    sum += light.lamp_ambient + panel_irradiance(scene_.bvh, light.lamp, point, normal, 1, false);
  return sum;
}

bool Renderer::on_rim(int x, int y) const {
  const auto surface = [&](int px, int py) {
    return seen_by(static_cast<std::size_t>(py * width_ + px)).surface;
  };
  const int here = surface(x, y);
  return (x > 0 && surface(x - 1, y) != here) || (x + 1 < width_ && surface(x + 1, y) != here) ||
         (y > 0 && surface(x, y - 1) != here) || (y + 1 < height_ && surface(x, y + 1) != here);
}

// `footprint`: width of the pixel across the ray, at the hit. depth: number of mirror reflections so far.
Rgb Renderer::radiance_at(Float3 origin, Float3 direction, const Hit& hit, float footprint,
                          const LightState& light, float lamp_visible, int depth) {
  const Solid& solid = scene_.solids[static_cast<std::size_t>(hit.solid)];
  const Material& material = scene_.material(hit.surface());
  const Float3 point = origin + direction * hit.t;
  const Float3 local = solid.to_local(point);
  const Float3 normal_local = face_normal(solid, hit.face, local);
  const Float3 normal = solid.rotate_to_world(normal_local);
  const Float3 towards = direction * (1.0F / norm(direction));
  const Float3 towards_local = solid.rotate_to_local(towards);
  const float cosine = std::max(std::abs(dot(normal, towards)), 0.02F);

  const FaceCoordinates c = face_coordinates(solid, hit.face, local);
  Float3 axis_u;
  Float3 axis_v;
  face_axes(solid, hit.face, local, axis_u, axis_v);
  // Extent along each axis of the face of a disc across the ray, projected along the ray onto the surface.
  const float slope_u = dot(axis_u, towards_local) / cosine;
  const float slope_v = dot(axis_v, towards_local) / cosine;
  const SurfaceSample sample{c.u,
                             c.v,
                             footprint * std::sqrt(1 + slope_u * slope_u),
                             footprint * std::sqrt(1 + slope_v * slope_v),
                             c.size_u,
                             c.size_v,
                             solid.seed};
  Rgb emitted;
  const Rgb albedo = shade_material(material, sample, emitted);

  const Lightmap::Light fixed = scene_.is_thing(hit.solid) ? unshadowed_light(point, normal)
                                                           : lightmap_.at(hit.solid, hit.face, c.u, c.v);
  float irradiance = light.ceiling * (fixed.direct + scene_.ambient * fixed.openness);
  float glint = 0;
  if (light.lamp_on) {
    irradiance += light.lamp_ambient * fixed.openness;
    if (lamp_visible > 0) {
      const float direct = lamp_visible * panel_irradiance(scene_.bvh, light.lamp, point, normal, 1, false);
      irradiance += direct;
      if (material.gloss > 0) {
        // The lamp's highlight: a Blinn lobe of exponent 64.
        float lobe = std::max(0.0F, dot(normal, normalised(normalised(light.lamp.centre - point) - towards)));
        for (int k = 0; k < 6; ++k) lobe *= lobe;
        glint = material.gloss * direct * lobe;
      }
    }
  }
  // The emission of ceiling panels is dimmed with the ceiling light; that of screens is constant.
  if (material.pattern == Pattern::kLampPanel) emitted = emitted * light.ceiling;
  Rgb colour = albedo * irradiance + emitted + Rgb{glint, glint, glint};

  const Float3 reflected = towards - normal * (2 * dot(normal, towards));
  const Ray ray{point + normal * kLift, reflected};
  if (depth == 0 && material.mirror > 0) {
    const Hit seen = scene_.closest(ray, kNear, kFar);
    if (seen.solid >= 0) {
      const float farther = footprint * (1 + seen.t / (norm(direction) * hit.t));
      colour = colour + radiance_at(ray.origin, ray.direction, seen, farther, light, 1, 1) * material.mirror;
    }
  }
  if (depth == 0 && material.gloss >= kReflectiveGloss) {
    float grazing = 1 - cosine;
    grazing =
        grazing * grazing * grazing * grazing * grazing;  // Schlick's approximation of Fresnel's equations
    const float mirror = material.gloss * (0.04F + 0.6F * grazing);
    const Hit seen = scene_.closest(ray, kNear, kFar);
    if (seen.solid >= 0) {
      // A polished surface is no perfect mirror: the blur of its image grows with the distance.
      const float blur = footprint + 0.05F * seen.t;
      colour = colour + radiance_at(ray.origin, ray.direction, seen, blur, light, 0, 1) * mirror;
    }
  }
  return colour;
}

Rgb Renderer::shade_rim(const LightState& light, int x, int y) {
  const auto i = static_cast<std::size_t>(y * width_ + x);
  const Float3 to_right = x + 1 < width_ ? ray(i + 1) - ray(i) : ray(i) - ray(i - 1);
  const auto row = static_cast<std::size_t>(width_);
  const Float3 to_below = y + 1 < height_ ? ray(i + row) - ray(i) : ray(i) - ray(i - row);
  Rgb sum;
  for (const auto& offset : kRimSamples) {
    const Float3 direction = view(y).to_world(ray(i) + to_right * offset[0] + to_below * offset[1]);
    const Hit hit = scene_.closest({view(y).origin, direction}, kNear, kFar);
    if (hit.solid < 0) continue;
    // Takes the lamp's visibility from a neighbouring pixel centre on the same surface.
    float lamp_visible = lamp_[i];
    bool found = seen_by(i).surface == hit.surface();
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, height_ - 1) && !found; ++ny) {
      for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, width_ - 1) && !found; ++nx) {
        const auto n = static_cast<std::size_t>(ny * width_ + nx);
        if (seen_by(n).surface != hit.surface()) continue;
        lamp_visible = lamp_[n];
        found = true;
      }
    }
    sum = sum +
          radiance_at(view(y).origin, direction, hit, 0.5F * pixel_angle_ * hit.t, light, lamp_visible, 0);
  }
  return sum * (1.0F / kRimSamples.size());
}

void Renderer::shade_rows(const LightState& light, int begin, int end) {
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto i = static_cast<std::size_t>(y * width_ + x);
      if (on_rim(x, y)) {
        radiance_[i] = shade_rim(light, x, y);
        continue;
      }
      const PixelHit& pixel = seen_by(i);
      if (pixel.surface < 0) {
        radiance_[i] = {};
        continue;
      }
      const Hit hit{pixel.depth_m, pixel.surface / Solid::kFaces, pixel.surface % Solid::kFaces};
      radiance_[i] = radiance_at(view(y).origin, view(y).to_world(ray(i)), hit, pixel_angle_ * pixel.depth_m,
                                 light, lamp_[i], 0);
    }
  }
}

}  // namespace plvo::sim
