// SPDX-License-Identifier: Apache-2.0
#include "plvo/image/depth_stretch.hpp"

#include <algorithm>

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr double kFractions = 65536;

std::int32_t units(double px) { return static_cast<std::int32_t>(px * kFractions); }

double magnitude(double x) { return x < 0 ? -x : x; }

}  // namespace

DepthStretch::DepthStretch(const DepthSampler& sampler, const Vector2& first, const Vector2& step, int count,
                           const Vector2& across, int reach)
    : sampler_(sampler),
      depth_(sampler.view()),
      first_(first),
      step_(step),
      across_px_(across),
      last_(count - 1),
      reach_(reach) {
  const double length = sqrt(step.squaredNorm());
  part_ = length * 2 < kPart_px ? static_cast<int>(kPart_px / std::max(length, 1.0)) : 1;
  end_known_ = work_out(0, end_);
  next_part();
}

bool DepthStretch::work_out(int i, Knot& knot) {
  const Vector2 seen = first_ + i * step_;
  const Exposure& exposure = sampler_.exposure();
  const Pinhole& pinhole = exposure.pinhole();
  Vector2 located = seen;
  Vector2 rate = Vector2::Zero();
  if (exposure.depth_apart()) {
    const bool led = depth_m_ > 0;
    if (!led) depth_m_ = DepthSampler::kAssumedDepth_m;
    located += shift_;
    if (!sampler_.follow(seen, led ? 1 : DepthSampler::kGuesses, located, depth_m_)) {
      shift_ = Vector2::Zero();
      depth_m_ = 0;
      return false;
    }
    shift_ = located - seen;
    knot.inverse_depth = 1 / depth_m_;
    // The transformation is affine in the point, so its effect on the camera centre gives the constant term.
    const Vector3 ray = back_project(pinhole, located.x(), located.y(), 1);
    const Vector3 moved = exposure.at_depth_time(Vector3::Zero(), seen.y(), located.y());
    rate = {pinhole.fx * (moved.x() - ray.x() * moved.z()), pinhole.fy * (moved.y() - ray.y() * moved.z())};
    knot.depth_offset = exposure.from_depth_time(Vector3::Zero(), seen.y(), located.y()).z();
    knot.depth_scale = exposure.from_depth_time(ray, seen.y(), located.y()).z() - knot.depth_offset;
  }
  const int x = std::clamp(static_cast<int>(located.x() + 0.5), 0, depth_.width - 1);
  const int y = std::clamp(static_cast<int>(located.y() + 0.5), 0, depth_.height - 1);
  const UndistortionMap::Window map(sampler_.map(), x, y);
  knot.at = map.position_px(located - Vector2(x, y));
  knot.across = map.step_px(across_px_);
  knot.rate = map.step_px(rate);
  return true;
}

void DepthStretch::next_part() {
  from_ = to_;
  to_ = std::min(from_ + part_, last_);
  start_ = end_;
  start_known_ = end_known_;
  end_known_ = work_out(to_, end_);
  known_ = start_known_ && end_known_;
  constexpr double kFar = 4 * UndistortionMap::kMaxSide;
  const auto near = [](const Vector2& p) { return p.cwiseAbs().maxCoeff() < kFar; };
  if (!known_) return;
  known_ = near(start_.at) && near(end_.at) && near(start_.across) && near(end_.across);
  if (!known_) return;
  const double share = 1.0 / std::max(to_ - from_, 1);
  start_x_ = units(start_.at.x() + 0.5);
  start_y_ = units(start_.at.y() + 0.5);
  along_.x = units(share * (end_.at.x() - start_.at.x()));
  along_.y = units(share * (end_.at.y() - start_.at.y()));
  along_.inverse_depth = share * (end_.inverse_depth - start_.inverse_depth);
  along_.depth_scale = share * (end_.depth_scale - start_.depth_scale);
  const Vector2 across = 0.5 * (start_.across + end_.across);
  across_.x = units(across.x());
  across_.y = units(across.y());
  rate_squared_ = start_.rate.squaredNorm();
  // The image is convex: if both ends are inside, the line between them is inside.
  const Vector2 margin(1 + reach_ * magnitude(across.x()), 1 + reach_ * magnitude(across.y()));
  const auto inside = [&](const Vector2& p) {
    return p.x() > margin.x() && p.y() > margin.y() && p.x() < depth_.width - 1 - margin.x() &&
           p.y() < depth_.height - 1 - margin.y();
  };
  all_inside_ = inside(start_.at) && inside(end_.at);
}

}  // namespace plvo
