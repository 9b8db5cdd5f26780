// SPDX-License-Identifier: Apache-2.0
// The things that are added to a room: a board, a walking person, a mirror. They are solids outside the
// room's hierarchy of boxes, placed anew for each image. They receive the light of the ceiling panels without
// shadows, and cast shadows of the lamp only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/scene/scene.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class Things {
 public:
  // Adds the materials to the scene. The trajectory determines where the things stand.
  Things(const SimulatorOptions& options, const Trajectory& trajectory, Scene& scene);

  // Places the things that exist at t_s into the scene. exposure_s: time for which the shutter is open, with
  // t_s in its middle; the film blurs the things accordingly.
  void place(double t_s, double exposure_s, Scene& scene) const;

 private:
  // An upright frame: the origin, and horizontal axes to the right and forward.
  struct Upright {
    Float3 origin, right, forward;
  };
  static Upright upright(const Se3& T_world_camera);
  static Float3 mean_velocity(const Trajectory& trajectory, double from_s, double to_s);
  // The solids that exist at present_s, where they are at t_s.
  std::vector<Solid> at(double present_s, double t_s) const;
  Solid panel(Float3 centre, const Upright& frame, Float3 half, std::uint16_t material) const;
  void add_person(double t_s, std::vector<Solid>& solids) const;

  Difficulties options_;
  Upright board_frame_, person_frame_, mirror_frame_;
  Float3 board_velocity_, person_velocity_;
  float board_half_width_m_ = 0;
  float board_centre_m_ = 0;  // to the right of the view's axis, when it appears
  std::uint16_t board_material_ = 0, mirror_material_ = 0;
  std::uint16_t shirt_ = 0, sleeve_ = 0, trousers_ = 0, skin_ = 0;
};

}  // namespace plvo::sim
