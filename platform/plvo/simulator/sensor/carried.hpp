// SPDX-License-Identifier: Apache-2.0
// What the camera carries along and shows at the same pixels in every frame: the robot's bumper, the dots of
// an infrared projector, the digits of a clock.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/simulator/render/renderer.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::sim {

class Carried {
 public:
  // Adds the bumper's solid and material to the scene. Must be called before things are placed.
  Carried(const SimulatorOptions& options, Scene& scene);

  // The hits with those of the bumper in front.
  ImageView<const PixelHit> cover(ImageView<const PixelHit> hits);
  // Puts the bumper, lit by `irradiance`, before the image, and adds the dots. level: radiance of a pixel
  // that is exposed to white.
  void add_light(float irradiance, float level, std::vector<Rgb>& image) const;
  // Draws the clock into an 8-bit RGB image.
  void burn_in(double t_s, std::uint8_t* rgb) const;

 private:
  void make_bumper(const SimulatorOptions& options, Scene& scene);
  void make_dots(const SimulatorOptions& options);

  int width_, height_;
  bool clock_;
  int bumper_top_;                  // first row of the bumper
  std::vector<PixelHit> bumper_;    // of the rows from bumper_top_ on
  std::vector<Rgb> bumper_albedo_;  // of the same rows
  std::vector<float> dots_;         // share of white; empty: none
  std::vector<PixelHit> hits_;
};

}  // namespace plvo::sim
