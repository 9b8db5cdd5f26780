// SPDX-License-Identifier: Apache-2.0
// Converts radiance to an 8-bit image. It models motion blur along each pixel's image velocity, an exposure
// that follows the scene's brightness with a lag, sensor noise (photon noise and read-out noise, both
// amplified in the dark), and the sRGB curve (IEC 61966-2-1).
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/image/image_view.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/render/renderer.hpp"

namespace plvo::sim {

class Film {
 public:
  Film(const CameraModel& camera, std::uint64_t seed, bool noise, int threads);

  // Exposure time of the next frame in seconds; known before the frame is rendered.
  double exposure_s() const { return exposure_s_; }

  // Takes the radiance rendered at mid-exposure and blurs it by motion. T_mid_begin, T_mid_end: pose of the
  // camera when the shutter opens and closes, in the camera frame at mid-exposure.
  void blur(Renderer& renderer, const Se3& T_mid_begin, const Se3& T_mid_end);
  // The blurred radiance. Before `expose`, light may be added that the camera's motion does not blur.
  std::vector<Rgb>& light() { return blurred_; }
  // Converts the blurred radiance to pixels. Then adapts the exposure of the next frame, `frame_s` later.
  void expose(std::uint32_t frame, double frame_s);
  // Radiance of the brightest pixel that is not over-exposed.
  double white() const;

  // 8-bit RGB, width·3 bytes per row.
  const std::uint8_t* pixels() const { return pixels_.data(); }
  std::uint8_t* pixels() { return pixels_.data(); }

 private:
  void meter(ImageView<const Rgb> radiance);
  void blur_rows(Renderer& renderer, const Se3& T_mid_begin, const Se3& T_mid_end, int begin, int end);
  void expose_rows(std::uint32_t frame, int begin, int end);

  CameraModel camera_;
  std::uint32_t seed_;
  bool noise_;
  int threads_;
  bool metered_ = false;
  double level_ = 1;     // mean radiance of the scene that the exposure assumes
  double measured_ = 1;  // mean radiance of the last frame
  double exposure_s_ = 0.01;
  float amplification_ = 1;  // gain of the noise
  std::vector<Rgb> blurred_;
  std::vector<double> row_sums_;
  std::vector<std::uint8_t> curve_;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace plvo::sim
