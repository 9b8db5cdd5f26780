// SPDX-License-Identifier: Apache-2.0
// Box P4 of the paper, with a binary descriptor in place of SURF's, after BRIEF (Calonder, Lepetit, Strecha &
// Fua, ECCV 2010): 256 comparisons of two pixels of a smoothed patch of 31×31, at places drawn once from a
// Gaussian about its centre. A comparison does not change under any increasing map of the grey levels, so
// neither gain nor offset of the light matters. It is not turned with the image: between the frames of one
// motion the roll is small, and docs/maths.md gives the measured rate of matches over roll and scale. Scale
// is the pyramid level's.
#pragma once

#include <array>
#include <cstdint>

#include "plvo/image/image_view.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

inline constexpr int kDescriptorRadius = 15;

// Describes the keypoints of one level.
class Describer {
 public:
  // smoothed: the level after smooth_binomial7, which must outlive the describer.
  explicit Describer(GrayView smoothed);
  // (x, y) at least kDescriptorRadius from the border.
  Descriptor operator()(int x, int y) const;

 private:
  // Of the two pixels of each comparison from the keypoint's.
  struct Offsets {
    std::int32_t a, b;
  };
  GrayView smoothed_;
  std::array<Offsets, 256> offsets_;
};

// Number of differing bits, 0 … 256.
int hamming_distance(const Descriptor& a, const Descriptor& b);

// The raw pixels around (x, y).
Patch cut_patch(GrayView image, int x, int y);

}  // namespace plvo
