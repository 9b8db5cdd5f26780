// SPDX-License-Identifier: Apache-2.0
// Checks the first frames of any camera for faults that spoil a run without an error: black colour, empty
// depth, depth in another unit, depth that is mirrored against colour. It changes nothing and takes about a
// millisecond per frame.
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
  // Returns the findings after enough frames, once: a sentence each, with its remedy.
  std::vector<std::string> add(const RgbdFrame& frame);
  // Returns the findings at the end of a shorter sequence.
  std::vector<std::string> finish();

 private:
  static constexpr int kFrames = 40;
  static constexpr std::size_t kBins = 2000;
  static constexpr double kBin_m = 0.02;

  void look(const RgbdFrame& frame);
  // The smallest depth that is not exceeded by this share of the depths so far.
  double depth_quantile(double share) const;
  std::string finding_of_colour() const;
  std::string finding_of_unit() const;

  int frames_ = 0;
  bool done_ = false;
  int darkest_ = 255, brightest_ = 0;
  std::uint64_t pixels_ = 0, depths_ = 0;
  std::array<std::uint32_t, kBins> histogram_{};  // of depth; the last bin counts all depths beyond
  double units_per_metre_ = 0;
  EdgeAgreement edges_;
};

}  // namespace plvo
