// SPDX-License-Identifier: Apache-2.0
// Box P4 of the paper, with a binary descriptor in place of SURF's, after BRIEF (Calonder, Lepetit, Strecha &
// Fua, ECCV 2010). It consists of 256 comparisons of two pixels of a smoothed 31×31 patch, at positions drawn
// once from a Gaussian around its centre. Comparisons are invariant to any increasing map of the grey levels,
// and hence to gain and offset of the illumination. The descriptor is not rotated with the image, because the
// roll between two frames is small; docs/decisions/descriptor_roll.md gives the measured matching rate over
// roll and scale. The pyramid level determines the scale.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/image/image_view.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

inline constexpr int kDescriptorRadius = 15;

// Computes the descriptors of one level's keypoints.
class Describer {
 public:
  // smoothed: the level after smooth_binomial7. It must outlive the describer.
  explicit Describer(GrayView smoothed);
  // (x, y) must be at least kDescriptorRadius away from the border.
  Descriptor operator()(int x, int y) const;

 private:
  // Memory offsets of the two pixels of a comparison, relative to the keypoint.
  struct Offsets {
    std::int32_t a, b;
  };
  GrayView smoothed_;
  std::array<Offsets, 256> offsets_;
};

// Number of differing bits, 0 … 256.
int hamming_distance(const Descriptor& a, const Descriptor& b);

// Copies the raw pixels around (x, y).
Patch cut_patch(GrayView image, int x, int y);

}  // namespace plvo
