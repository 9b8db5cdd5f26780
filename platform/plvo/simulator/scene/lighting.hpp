// SPDX-License-Identifier: Apache-2.0
// The light at a given time. "constant": the ceiling panels. "varying": an LED panel carried beside the
// camera swings and dims, as in the paper's experiment, and the ceiling panels emit a twentieth of their
// light.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/math/se3.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::sim {

struct LightState {
  float ceiling = 1;  // share of the ceiling panels' power
  bool lamp_on = false;
  PanelLight lamp;         // current pose and power of the panel
  float lamp_ambient = 0;  // lamp light that the room reflects diffusely
};

class Lighting {
 public:
  Lighting(LightName name, std::uint64_t seed);
  // T_world_camera: pose of the camera at `t_s` (seconds since the first frame).
  LightState at(double t_s, const Se3& T_world_camera) const;

 private:
  struct Wave {
    double frequency_hz = 1;
    double phase_rad = 0;
  };
  double wave(int k, double t_s) const;

  LightName name_;
  std::array<Wave, 7> waves_;
};

}  // namespace plvo::sim
