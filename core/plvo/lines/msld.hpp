// SPDX-License-Identifier: Apache-2.0
// Box L4 of the paper: the mean–standard-deviation line descriptor of Wang, Wu and Hu, "MSLD: A robust
// descriptor for line matching", Pattern Recognition 42(5), 2009. A region along the segment is cut into
// kMsldBands bands parallel to it. In every column across the segment, each band sums the gradients as they
// stand to the segment: towards its brighter side, away from it, along it and against it, four non-negative
// numbers. The descriptor is their mean and their SD over the columns. Both halves are normalised by
// themselves, so a linear change of the light cancels; an offset cancels in the gradient already.
//
// Columns and rows are kept few, since neighbouring ones tell the same.
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
inline constexpr int kMsldRowPitch_px = 1;  // of the image that is described, at half resolution 54 px in all
inline constexpr int kMsldMaxColumns = 16;
inline constexpr std::size_t kMsldLength = 2 * 4 * kMsldBands;

// Bands × 4 means, bands × 4 SDs; each half has unit norm, in units of 1/255.
struct LineDescriptor {
  std::array<std::uint8_t, kMsldLength> value{};
};

// `image` shows pixel p of the segment's image at p · scale (a pyramid level: scale = 2^-level). What lies
// outside the image has no gradient. Flat surroundings give the zero descriptor.
LineDescriptor describe_segment(GrayView image, double scale, const Segment& segment);

// Squared distance, 0 … 4 · 255².
int descriptor_distance(const LineDescriptor& a, const LineDescriptor& b);

}  // namespace plvo
