// SPDX-License-Identifier: Apache-2.0
// Reads depth along a straight stretch of the colour image, at places that are evenly spaced, and across it.
// Where depth shows a place (DepthSampler::locate) and where the lens puts that is worked out every 32 px;
// between, both follow a straight line, which for a Kinect is off by less than a quarter of a pixel. Where
// the depth that is read says that another surface is seen, it is read anew where depth shows that one.
#pragma once

#include <cstdint>

#include "plvo/image/depth_sampler.hpp"

namespace plvo {

class DepthStretch {
 public:
  // Places first, first + step, …, of the colour image; readings up to `reach` times `across` to either side.
  DepthStretch(const DepthSampler& sampler, const Vector2& first, const Vector2& step, int count,
               const Vector2& across, int reach);

  // To place i < count, each place after the one before; false where nobody knows where depth shows it.
  bool go_to(int i) {
    if (i > to_) next_part();
    if (!known_) return false;
    n_ = i - from_;
    x_ = start_x_ + n_ * along_.x;
    y_ = start_y_ + n_ * along_.y;
    inside_ = all_inside_;
    return rate_squared_ <= 0 || follow_surface();
  }
  // The depth there, or so many times `across` beside it, in metres; 0: none.
  double at(int times) const {
    const int x = (x_ + times * across_.x) >> kFractionBits;
    const int y = (y_ + times * across_.y) >> kFractionBits;
    if (!inside_ && !is_inside(x, y)) return 0;
    return depth_.data[y * depth_.stride + x] * depth_.metres_per_unit;
  }
  // Such a depth, as it was when colour's row of the place was exposed.
  double at_colour_time(double depth_m) const {
    return (start_.depth_scale + n_ * along_.depth_scale) * depth_m + start_.depth_offset;
  }

 private:
  static constexpr int kFractionBits = 16;
  static constexpr int kPart_px = 32;
  // A surface that is seen so far from where it was looked for is looked for anew.
  static constexpr double kOff_px = 0.25;

  // What is worked out for a place.
  struct Knot {
    Vector2 at = Vector2::Zero();  // px of the raw image
    Vector2 across = Vector2::Zero();
    Vector2 rate = Vector2::Zero();  // of `at` by inverse depth, px m
    double inverse_depth = 0;        // where this was seen, 1/m
    double depth_scale = 1;          // from depth's time to colour's: scale · depth + offset
    double depth_offset = 0;
  };
  // From a place to the next.
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
    const double apart = 1 - z * inverse;  // of the inverse depths, times z
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
  int part_ = 1;  // places

  // The part from one place to another, with what is worked out at its ends.
  int from_ = 0, to_ = 0;
  Knot start_, end_;
  bool known_ = false, start_known_ = false, end_known_ = false;
  bool all_inside_ = false;
  std::int32_t start_x_ = 0, start_y_ = 0;  // 2^-16 px, and half a pixel
  Step along_, across_;
  double rate_squared_ = 0;
  // Where the depth image showed the last place that was worked out, and how deep.
  Vector2 shift_ = Vector2::Zero();
  double depth_m_ = 0;

  int n_ = 0;
  std::int32_t x_ = 0, y_ = 0;
  bool inside_ = false;
};

}  // namespace plvo
