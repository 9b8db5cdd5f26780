// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/lighting.hpp"

#include "plvo/base/random.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

constexpr float kCeilingLeft = 0.05F;   // share of the ceiling light's power while the lamp is in use
constexpr float kLampPower = 22;        // at full brightness: about two thirds of a ceiling panel
constexpr float kLampAmbient = 0.012F;  // share of the lamp's power
constexpr float kLampHalf = 0.15F;      // m, half edge of the panel
constexpr double kDimmest = 0.12;       // share of the full brightness
constexpr double kSwing_rad = 0.55;     // to either side
constexpr double kNod_rad = 0.28;

}  // namespace

Lighting::Lighting(LightName name, std::uint64_t seed) : name_(name) {
  Random random(seed, 0x4c49);
  // Two waves each for the swing, the nod and the brightness; one for the arm that holds the lamp.
  constexpr std::array<double, 7> kFrequency_hz = {0.45, 0.21, 0.6, 0.27, 0.33, 0.75, 0.5};
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    waves_[k].frequency_hz = kFrequency_hz[k] * (0.85 + 0.3 * random.uniform());
    waves_[k].phase_rad = 2 * kPi * random.uniform();
  }
}

double Lighting::wave(int k, double t_s) const {
  const Wave& w = waves_[static_cast<std::size_t>(k)];
  return sin(2 * kPi * w.frequency_hz * t_s + w.phase_rad);
}

LightState Lighting::at(double t_s, const Se3& T_world_camera) const {
  LightState state;
  if (name_ == LightName::kConstant) return state;
  state.ceiling = kCeilingLeft;
  state.lamp_on = true;
  const double swing = kSwing_rad * (0.7 * wave(0, t_s) + 0.3 * wave(1, t_s));
  const double nod = kNod_rad * (0.7 * wave(2, t_s) + 0.3 * wave(3, t_s));
  const double brightness = 0.5 + 0.5 * (0.65 * wave(4, t_s) + 0.35 * wave(5, t_s));

  // The lamp is held to the right of the camera and above it, in the camera's frame (x right, y down, z
  // forward).
  const Vector3 held(0.38 + 0.1 * wave(6, t_s), -0.3, 0.05);
  const Matrix3 R_camera_lamp = rotation_exp(Vector3(0, swing, 0)) * rotation_exp(Vector3(nod, 0, 0));
  const Matrix3 R_world_lamp = T_world_camera.R * R_camera_lamp;
  state.lamp.centre = to_float(T_world_camera * held);
  state.lamp.half_u = to_float(R_world_lamp.col(0)) * kLampHalf;
  state.lamp.half_v = to_float(R_world_lamp.col(1)) * kLampHalf;
  state.lamp.normal = to_float(R_world_lamp.col(2));
  state.lamp.power = kLampPower * static_cast<float>(kDimmest + (1 - kDimmest) * brightness * brightness);
  state.lamp_ambient = kLampAmbient * state.lamp.power;
  return state;
}

}  // namespace plvo::sim
