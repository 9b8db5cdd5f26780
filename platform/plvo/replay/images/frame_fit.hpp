// SPDX-License-Identifier: Apache-2.0
// Prepares the images of a recording of any format for the odometry. Images that are larger than the core
// takes, or that the user wants smaller, are scaled down (image_reduction.hpp). Depth of its own size or
// camera is registered to colour (depth_registration.hpp). The class owns the pixels: the reader writes the
// recorded images into colour() and depth(), and gets frames that point into them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/depth_registration.hpp"
#include "plvo/replay/images/image_reduction.hpp"

namespace plvo {

// The largest 16-bit value is not a depth, whatever the unit and the recorder: sensors and exporters write it
// for missing depth and for depth beyond their range. It becomes 0.
inline constexpr std::uint16_t kDepthBeyondRange = 65535;

struct ImageSize {
  int width = 0, height = 0;  // px
};

class FrameFit {
 public:
  // Sizes are those of the recording; calibration: of colour in that size. scale_down 0: the smallest factor
  // that the images need. Allocates all memory. Returns kInvalidArgument if the relation of depth to colour
  // is not specified, or if the calibration or the factor does not fit.
  Status init(const Calibration& calibration, const ImageSize& colour, const ImageSize& depth,
              int scale_down);

  const Calibration& calibration() const { return calibration_; }  // in force; with the size of the frames
  // Size as recorded; its width is 0 after an init() that failed before the check of scale_down.
  const WholeImage& whole_image() const { return whole_; }
  // "… are scaled down …" if the user did not ask for it; else empty.
  const std::string& remark() const { return remark_; }

  std::span<std::uint8_t> colour() { return whole_.factor > 1 ? whole_colour_ : colour_; }  // RGB
  std::span<std::uint16_t> depth() { return registers_ ? raw_depth_ : depth_; }
  // Makes a frame of the pixels in colour() and depth(), where 65535 becomes 0 (no depth). The frame is valid
  // until they are written to. Stamps are not changed.
  void fit(RgbdFrame& frame);

 private:
  // Fails if the calibration does not specify the relation of depth to colour.
  Status choose_registration(const ImageSize& colour, const ImageSize& depth);
  Status choose_scale(const ImageSize& colour, int scale_down);

  Calibration calibration_;
  WholeImage whole_;
  std::string remark_;
  bool registers_ = false;
  DepthRegistration registration_;
  std::vector<std::uint8_t> whole_colour_;  // used if it is scaled down
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> raw_depth_;  // used if it is registered
  std::vector<std::uint16_t> depth_;
};

}  // namespace plvo
