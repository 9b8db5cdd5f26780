// SPDX-License-Identifier: Apache-2.0
// Places solids and lights of a room, and draws random properties from the seed.
#pragma once

#include <cstdint>
#include <memory>

#include "plvo/base/random.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

class SceneBuilder {
 public:
  explicit SceneBuilder(std::uint64_t seed);

  std::uint16_t material(const Material& material);
  // An axis-aligned box between two corners.
  Solid& box(Float3 lo, Float3 hi, std::uint16_t material);
  // A box rotated by `yaw` about the vertical and then by `tilt` about its own y axis.
  Solid& turned_box(Float3 centre, Float3 half, float yaw, float tilt, std::uint16_t material);
  Solid& cylinder(Float3 centre, float radius, float half_length, std::uint16_t material);
  // A cylinder between two points.
  Solid& rod(Float3 a, Float3 b, float radius, std::uint16_t material);
  // A light panel below `ceiling_z`, with its frame.
  void ceiling_panel(float x, float y, float ceiling_z, float half_x, float half_y, float power);
  // Floor, ceiling and the four walls around the space lo … hi, 0.2 m thick.
  void shell(Float3 lo, Float3 hi, std::uint16_t floor, std::uint16_t ceiling, std::uint16_t wall);

  float uniform(float lo, float hi) { return lo + (hi - lo) * static_cast<float>(random_.uniform()); }
  bool chance(float probability) { return uniform(0, 1) < probability; }
  // A colour of the given lightness with a hue drawn from the seed.
  Rgb colour(float lightness, float saturation);

  Scene& scene() { return *scene_; }
  std::unique_ptr<Scene> finish();

 private:
  std::unique_ptr<Scene> scene_;
  Random random_;
  std::uint16_t panel_material_ = 0, frame_material_ = 0;
};

// One function per room.
std::unique_ptr<Scene> build_corridor(std::uint64_t seed);
std::unique_ptr<Scene> build_staircase(std::uint64_t seed);
std::unique_ptr<Scene> build_hall(std::uint64_t seed);
std::unique_ptr<Scene> build_desk(std::uint64_t seed);
std::unique_ptr<Scene> build_bare(std::uint64_t seed);

}  // namespace plvo::sim
