// SPDX-License-Identifier: Apache-2.0
// What a recording's images go through on their way to the odometry, whatever they are recorded in: images
// that are larger than the core takes, or that one asks for smaller, are scaled down (image_reduction.hpp);
// depth of its own size or camera is registered to colour (depth_registration.hpp). It owns the pixels: the
// reader puts what was recorded into colour() and depth(), and gets frames that look into them.
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

// What 16 bits hold at the most is no depth, in whatever unit and whoever recorded it: sensors and exporters
// write it where they see nothing, and for what is further than they can say. It becomes 0.
inline constexpr std::uint16_t kDepthBeyondRange = 65535;

struct ImageSize {
  int width = 0, height = 0;  // px
};

class FrameFit {
 public:
  // Sizes as they are recorded; calibration: of colour in that size. scale_down 0: by as little as the images
  // need. Takes all memory. kInvalidArgument for depth of which nobody says how it goes with colour, a
  // calibration that does not fit, or a factor that does not.
  Status init(const Calibration& calibration, const ImageSize& colour, const ImageSize& depth,
              int scale_down);

  const Calibration& calibration() const { return calibration_; }  // in force; with the size of the frames
  // As recorded; after an init() that failed without a word on scale_down, of width 0.
  const WholeImage& whole_image() const { return whole_; }
  // "… are scaled down …", where nobody asked for it; else empty.
  const std::string& remark() const { return remark_; }

  std::span<std::uint8_t> colour() { return whole_.factor > 1 ? whole_colour_ : colour_; }  // RGB
  std::span<std::uint16_t> depth() { return registers_ ? raw_depth_ : depth_; }
  // Of what stands in colour() and depth(), where 65535 becomes 0, none; valid until they are written to.
  // Stamps are left alone.
  void fit(RgbdFrame& frame);

 private:
  // Refused where the calibration does not say how depth goes with colour.
  Status choose_registration(const ImageSize& colour, const ImageSize& depth);
  Status choose_scale(const ImageSize& colour, int scale_down);

  Calibration calibration_;
  WholeImage whole_;
  std::string remark_;
  bool registers_ = false;
  DepthRegistration registration_;
  std::vector<std::uint8_t> whole_colour_;  // where it is scaled down
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> raw_depth_;  // where it is registered
  std::vector<std::uint16_t> depth_;
};

}  // namespace plvo
