// SPDX-License-Identifier: Apache-2.0
// Model of the structured-light depth sensor: converts the exact depth of every pixel to the depth that a
// Kinect v1 would report, registered to the colour image. The disparity is d = f·b/z for a projector at
// baseline b along +x. Noise is added to the disparity, which is then rounded to 1/8 px. The standard
// deviation of the sum of both, in depth, is noise_scale · σ_d(z) of equation (2) wherever (2) exceeds the
// rounding error. A scale error multiplies the reported depth. Pixels without depth: out of range; occluded
// from the projector (bands at the left of near objects); too little returned light (dark, distant, grazing
// or polished surfaces); the mirror image of the projector.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/simulator/render/ray_caster.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

constexpr double kMetresPerUnit = 0.0002;  // TUM: 5000 units per metre

class KinectDepth {
 public:
  KinectDepth(const Scene& scene, const CameraModel& camera, const DepthSensorOptions& options,
              std::uint64_t seed, int threads);

  void sense(ImageView<const PixelHit> hits, std::uint32_t frame);
  // Noise-free depth: exact but for the scale error, rounded to the unit of the format.
  void copy_exact(ImageView<const PixelHit> hits);

  // Empties every second row and column, as of a coarser depth camera that is registered to colour.
  void comb();

  DepthView view() const;

 private:
  void sense_row(ImageView<const PixelHit> hits, std::uint32_t frame_seed, int y);

  const Scene& scene_;
  DepthSensorOptions options_;
  std::uint32_t seed_;
  int width_, height_, threads_;
  float colour_to_infrared_;  // pixels of the infrared camera per pixel of the colour camera
  std::vector<std::uint16_t> depth_;
};

}  // namespace plvo::sim
