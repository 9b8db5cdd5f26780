// SPDX-License-Identifier: Apache-2.0
// Reads depth at evenly spaced positions along a straight line of the colour image, and across that line. The
// position in the depth image (DepthSampler::locate) and the distortion are computed every 32 px and
// interpolated linearly in between; for a Kinect, the error is below a quarter of a pixel. If the depth shows
// that another surface is visible, the position is corrected for that surface and the depth is read again.
#pragma once

#include <cstdint>

#include "plvo/image/depth_sampler.hpp"

namespace plvo {

class DepthStretch {
 public:
  // Positions first, first + step, … in the colour image. Readings extend up to `reach` times `across` to
  // either side.
  DepthStretch(const DepthSampler& sampler, const Vector2& first, const Vector2& step, int count,
               const Vector2& across, int reach);

  // Moves to position i < count; i must increase from call to call. Returns false if the position in the
  // depth image is unknown.
  bool go_to(int i) {
    if (i > to_) next_part();
    if (!known_) return false;
    n_ = i - from_;
    x_ = start_x_ + n_ * along_.x;
    y_ = start_y_ + n_ * along_.y;
    inside_ = all_inside_;
    return rate_squared_ <= 0 || follow_surface();
  }
  // Depth at the current position plus `times` · `across`, in metres; 0: no depth.
  double at(int times) const {
    const int x = (x_ + times * across_.x) >> kFractionBits;
    const int y = (y_ + times * across_.y) >> kFractionBits;
    if (!inside_ && !is_inside(x, y)) return 0;
    return depth_.data[y * depth_.stride + x] * depth_.metres_per_unit;
  }
  // DepthSampler::sample_between() at the current position; it may lie outside of the image.
  DepthSample between() const { return sampler_.sample_between(x_ >> kFractionBits, y_ >> kFractionBits); }
  // Transforms such a depth to the exposure time of the colour row of the current position.
  double at_colour_time(double depth_m) const {
    return (start_.depth_scale + n_ * along_.depth_scale) * depth_m + start_.depth_offset;
  }

 private:
  static constexpr int kFractionBits = 16;
  static constexpr int kPart_px = 32;
  // Displacement above which the position of a surface is corrected.
  static constexpr double kOff_px = 0.25;

  // Values computed at one position.
  struct Knot {
    Vector2 at = Vector2::Zero();  // px of the raw image
    Vector2 across = Vector2::Zero();
    Vector2 rate = Vector2::Zero();  // derivative of `at` with respect to inverse depth, px m
    double inverse_depth = 0;        // inverse depth used for `at`, 1/m
    double depth_scale = 1;          // from depth's time to colour's: scale · depth + offset
    double depth_offset = 0;
  };
  // Increments from one position to the next.
  struct Step {
    std::int32_t x = 0, y = 0;  // 2^-16 px
    double inverse_depth = 0;
    double depth_scale = 0;
  };

  bool is_inside(int x, int y) const {
    return static_cast<unsigned>(x) < static_cast<unsigned>(depth_.width) &&
           static_cast<unsigned>(y) < static_cast<unsigned>(depth_.height);
  }
  void next_part();
  bool work_out(int i, Knot& knot);
  bool follow_surface() {
    const double z = at(0);
    const double inverse = start_.inverse_depth + n_ * along_.inverse_depth;
    const double apart = 1 - z * inverse;  // difference of the inverse depths, times z
    if (!(apart * apart * rate_squared_ > kOff_px * kOff_px * (z * z)) || !(z > 0)) return true;
    const Vector2 off = (apart / z) * start_.rate;
    constexpr double kFar = UndistortionMap::kMaxSide;
    if (!(off.squaredNorm() < kFar * kFar)) return false;
    x_ += static_cast<std::int32_t>(off.x() * (1 << kFractionBits));
    y_ += static_cast<std::int32_t>(off.y() * (1 << kFractionBits));
    inside_ = false;
    return true;
  }

  const DepthSampler& sampler_;
  const DepthView depth_;
  const Vector2 first_, step_, across_px_;
  const int last_, reach_;
  int part_ = 1;  // length in positions

  // The current part of the line, with the values at its ends.
  int from_ = 0, to_ = 0;
  Knot start_, end_;
  bool known_ = false, start_known_ = false, end_known_ = false;
  bool all_inside_ = false;
  std::int32_t start_x_ = 0, start_y_ = 0;  // 2^-16 px, with half a pixel added for rounding
  Step along_, across_;
  double rate_squared_ = 0;
  // Displacement in the depth image and depth at the last computed position.
  Vector2 shift_ = Vector2::Zero();
  double depth_m_ = 0;

  int n_ = 0;
  std::int32_t x_ = 0, y_ = 0;
  bool inside_ = false;
};

}  // namespace plvo
