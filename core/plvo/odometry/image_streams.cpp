// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/image_streams.hpp"

#include "plvo/odometry/elapsed.hpp"

namespace plvo {
namespace {

// Distance between the pixels of the grid. It is odd, because some depth images have readings in every second
// row and column only.
constexpr int kGridStep = 7;
// Each row of the grid begins this much further to the right, so that the grid meets lines in any direction.
constexpr int kGridShift = 3;
// A depth image with fewer readings on the grid is not compared: an empty one has nothing to repeat.
constexpr int kLeastReadingsCompared = 50;
// A depth camera in its slowest usual mode delivers six images a second.
constexpr std::int64_t kOldestDepth_ns = 200'000'000;
// A camera that stands still may see the same depth for ever, if the depth has no noise (a simulator). The
// depth is called stopped when the camera has moved, or turned, by this much since the image came.
constexpr double kMovedSinceDepth_m = 0.01, kTurnedSinceDepth_rad = 0.01;

// FNV-1a over whole pixels. Grids that differ in one pixel never have the same hash.
class GridHash {
 public:
  void add(std::uint32_t pixel) { value_ = (value_ ^ pixel) * 0x100000001b3ULL; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

template <typename Visit>
void visit_grid(int width, int height, GrayView mask, const Visit& visit) {
  int first = 0;
  for (int y = 0; y < height; y += kGridStep) {
    for (int x = first; x < width; x += kGridStep)
      if (mask.data == nullptr || mask.at(x, y) != 0) visit(x, y);
    first = (first + kGridShift) % kGridStep;
  }
}

std::uint64_t hash_of(const ColourView& colour, GrayView mask) {
  GridHash hash;
  const bool gray = colour.format == PixelFormat::kGray8;
  visit_grid(colour.width, colour.height, mask, [&](int x, int y) {
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

std::uint64_t hash_of(const DepthView& depth, GrayView mask, int& readings) {
  GridHash hash;
  readings = 0;
  visit_grid(depth.width, depth.height, mask, [&](int x, int y) {
    const std::uint16_t reading = depth.data[y * depth.stride + x];
    readings += reading != 0 ? 1 : 0;
    hash.add(reading);
  });
  return hash.value();
}

}  // namespace

void ColourStream::look(const RgbdFrame& frame, GrayView mask) {
  const std::uint64_t hash = hash_of(frame.colour, mask);
  is_repeated_ = has_frame_ && hash == hash_;
  hash_ = hash;
  has_frame_ = true;
}

void DepthStream::look(const RgbdFrame& frame, GrayView mask) {
  int readings = 0;
  const std::uint64_t hash = hash_of(frame.depth, mask, readings);
  is_repeated_ = has_frame_ && hash == hash_ && readings >= kLeastReadingsCompared;
  if (!is_repeated_) {
    has_stopped_ = false;
    first_ns_ = frame.stamp_ns;
    first_depth_stamp_ns_ = frame.depth_stamp_ns;
  }
  age_ns_ = elapsed_ns(first_ns_, frame.stamp_ns);
  hash_ = hash;
  has_frame_ = true;
}

bool DepthStream::is_too_old_for(const Se3& T_current_first) const {
  const Vector6 moved = boxminus(T_current_first, Se3{});
  return age_ns_ > kOldestDepth_ns &&
         (moved.head<3>().norm() > kMovedSinceDepth_m || moved.tail<3>().norm() > kTurnedSinceDepth_rad);
}

Status DepthStream::explain_stop(const char* first_word) const {
  return Status(StatusCode::kDamaged, first_word)
      .append("the depth image has been the same for ")
      .append(static_cast<std::ptrdiff_t>(1e-6 * static_cast<double>(age_ns_)))
      .append(" ms while the colour image moves: the depth stream has stopped; restart the camera");
}

}  // namespace plvo
