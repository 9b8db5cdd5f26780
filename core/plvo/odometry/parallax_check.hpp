// SPDX-License-Identifier: Apache-2.0
// Whether what the camera sees lies where its depth is measured. In a mirror, behind glass and in the light
// of a projector it does not: the motion by parallax is then a share of the motion by depth. So what the
// depths add to the motion (z, depth_shift.hpp) is in proportion to the motion along the optical axis, t_z,
// in one frame after the other. The ratio r of the two, over about a second, is
//
//   r = Σ w z t_z / Σ w t_z²,   var r = 1 / Σ w t_z² + σ²,
//
// with the information w of z, older frames fading by κ = τ / (τ + Δt). σ is what the calibration of a
// camera explains: an offset of depth or a wrong focal length.
#pragma once

#include "plvo/motion/depth_shift.hpp"

namespace plvo {

class ParallaxCheck {
 public:
  // Notes a tracked frame, elapsed_s after the last one.
  void note(const DepthShift& shift, double elapsed_s);
  // Whether depth has moved farther than parallax, beyond the noise of the ratio.
  bool fails() const { return fails_; }

 private:
  double product_ = 0;  // Σ w z t_z
  double square_ = 0;   // Σ w t_z²
  bool fails_ = false;
};

}  // namespace plvo
