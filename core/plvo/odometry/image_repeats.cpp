// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/image_repeats.hpp"

#include "plvo/odometry/elapsed.hpp"

namespace plvo {
namespace {

// Distance between the pixels of the grid. It is odd, because some depth images have readings in every second
// row and column only.
constexpr int kGridStep = 7;
// Each row of the grid begins this much further to the right, so that the grid meets lines in any direction.
constexpr int kGridShift = 3;
// A depth image with fewer readings on the grid is not compared: an empty one has nothing to repeat.
constexpr int kLeastRepeatedReadings = 50;

// FNV-1a over whole pixels. Grids that differ in one pixel never have the same hash.
class GridHash {
 public:
  void add(std::uint32_t pixel) { value_ = (value_ ^ pixel) * 0x100000001b3ULL; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

template <typename Visit>
void visit_grid(int width, int height, const Visit& visit) {
  int first = 0;
  for (int y = 0; y < height; y += kGridStep) {
    for (int x = first; x < width; x += kGridStep) visit(x, y);
    first = (first + kGridShift) % kGridStep;
  }
}

std::uint64_t hash_of(const ColourView& colour) {
  GridHash hash;
  const bool gray = colour.format == PixelFormat::kGray8;
  visit_grid(colour.width, colour.height, [&](int x, int y) {
    const std::uint8_t* row = colour.data + y * colour.stride_bytes;
    if (gray) {
      hash.add(row[x]);
    } else {
      const std::uint8_t* pixel = row + 3 * x;
      hash.add(pixel[0] | std::uint32_t{pixel[1]} << 8 | std::uint32_t{pixel[2]} << 16);
    }
  });
  return hash.value();
}

std::uint64_t hash_of(const DepthView& depth, int& readings) {
  GridHash hash;
  readings = 0;
  visit_grid(depth.width, depth.height, [&](int x, int y) {
    const std::uint16_t reading = depth.data[y * depth.stride + x];
    readings += reading != 0 ? 1 : 0;
    hash.add(reading);
  });
  return hash.value();
}

}  // namespace

void ImageRepeats::look(const RgbdFrame& frame) {
  int readings = 0;
  const std::uint64_t colour = hash_of(frame.colour);
  const std::uint64_t depth = hash_of(frame.depth, readings);
  colour_is_repeated_ = has_frame_ && colour == colour_hash_;
  depth_is_repeated_ = has_frame_ && depth == depth_hash_ && readings >= kLeastRepeatedReadings;
  if (!depth_is_repeated_) {
    depth_first_ns_ = frame.stamp_ns;
    depth_stamp_ns_ = frame.depth_stamp_ns;
  }
  depth_age_ns_ = elapsed_ns(depth_first_ns_, frame.stamp_ns);
  colour_hash_ = colour;
  depth_hash_ = depth;
  has_frame_ = true;
}

}  // namespace plvo
