// SPDX-License-Identifier: Apache-2.0
// Box L4 of the paper: the mean–standard-deviation line descriptor of Wang, Wu and Hu, "MSLD: A robust
// descriptor for line matching", Pattern Recognition 42(5), 2009. A region along the segment is divided into
// kMsldBands bands parallel to it. In every column across the segment, each band sums the gradients by their
// direction relative to the segment: towards its brighter side, away from it, along it and against it. These
// are four non-negative numbers. The descriptor consists of their means and standard deviations over the
// columns. Each half is normalised by itself, so linear changes of the illumination cancel; an offset already
// cancels in the gradient.
//
// There are few columns and rows, because adjacent ones are redundant.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/image/image_view.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

inline constexpr int kMsldBands = 9;
inline constexpr int kMsldRowsPerBand = 3;
inline constexpr int kMsldRowPitch_px = 1;  // px of the described image; at half resolution 54 px in total
inline constexpr int kMsldMaxColumns = 16;
inline constexpr std::size_t kMsldLength = 2 * 4 * kMsldBands;

// Bands × 4 means, then bands × 4 standard deviations. Each half has unit norm, in units of 1/255.
struct LineDescriptor {
  std::array<std::uint8_t, kMsldLength> value{};
};

// `image` shows pixel p of the segment's image at p · scale (a pyramid level: scale = 2^-level). Pixels
// outside of the image have no gradient. Uniform surroundings give the zero descriptor.
LineDescriptor describe_segment(GrayView image, double scale, const Segment& segment);

// Squared distance, 0 … 4 · 255².
int descriptor_distance(const LineDescriptor& a, const LineDescriptor& b);

}  // namespace plvo
