// SPDX-License-Identifier: Apache-2.0
// Looks at the first frames of a camera, whatever it is, for what makes a run go wrong without an error:
// black colour, empty depth, depth in another unit, depth that lies mirrored over colour. It changes nothing,
// and takes about a millisecond in each of them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/replay/checks/edge_agreement.hpp"

namespace plvo {

class FrameCheck {
 public:
  // The findings, a sentence each with its remedy, when enough frames were seen; each once.
  std::vector<std::string> add(const RgbdFrame& frame);
  // The same at the end of a sequence that is shorter.
  std::vector<std::string> finish();

 private:
  static constexpr int kFrames = 40;
  static constexpr std::size_t kBins = 2000;
  static constexpr double kBin_m = 0.02;

  void look(const RgbdFrame& frame);
  // The least depth that `share` of the depths seen do not exceed.
  double depth_quantile(double share) const;
  std::string finding_of_colour() const;
  std::string finding_of_unit() const;

  int frames_ = 0;
  bool done_ = false;
  int darkest_ = 255, brightest_ = 0;
  std::uint64_t pixels_ = 0, depths_ = 0;
  std::array<std::uint32_t, kBins> histogram_{};  // of depth; the last bin has what lies beyond
  double units_per_metre_ = 0;
  EdgeAgreement edges_;
};

}  // namespace plvo
