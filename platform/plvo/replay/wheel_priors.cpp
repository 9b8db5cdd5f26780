// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/wheel_priors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plvo/motion/wheel_prior.hpp"

namespace plvo {
namespace {

// to_ns is not before from_ns; the two may be centuries apart.
double wheel_seconds(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(static_cast<std::uint64_t>(to_ns) - static_cast<std::uint64_t>(from_ns)) * 1e-9;
}

// On the line through two samples.
Vector3 velocity_at(const WheelSample& a, const WheelSample& b, std::int64_t stamp_ns) {
  const double u = wheel_seconds(a.stamp_ns, stamp_ns) / wheel_seconds(a.stamp_ns, b.stamp_ns);
  return (1 - u) * a.velocity + u * b.velocity;
}

Status refuse_wheel_config(const char* entry, const char* range) {
  return Status(StatusCode::kInvalidArgument, "wheels: ").append(entry).append(" must lie ").append(range);
}

}  // namespace

Status WheelConfig::validate() const {
  const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
  if (!is_rotation(T_base_camera.R) || !(T_base_camera.t.norm() <= 1000))
    return refuse_wheel_config("T_base_camera", "within 1000 m, and be a rotation");
  if (!within(share, 0, 10)) return refuse_wheel_config("share", "between 0 and 10");
  if (!within(track_m, 0.01, 100)) return refuse_wheel_config("track_m", "between 0.01 and 100 m");
  for (const double sigma : {least_mps, least_rps, bounce_mps, tilt_rps})
    if (!within(sigma, 1e-6, 100)) return refuse_wheel_config("a standard deviation", "between 1e-6 and 100");
  if (!within(error_s, 0, 1000)) return refuse_wheel_config("error_s", "between 0 and 1000 s");
  if (!within(longest_gap_s, 1e-3, 100))
    return refuse_wheel_config("longest_gap_s", "between 0.001 and 100 s");
  if (!within(hold_s, 0, longest_gap_s)) return refuse_wheel_config("hold_s", "between 0 and longest_gap_s");
  for (const double acceleration : {acceleration_mps2, acceleration_rps2})
    if (!within(acceleration, 0, 1000))
      return refuse_wheel_config("an acceleration", "between 0 and 1000 m/s² or rad/s²");
  return {};
}

Status WheelPriors::init(WheelRecording recording, const WheelConfig& config) {
  if (Status status = config.validate(); !status.ok()) return status;
  samples_ = std::move(recording.samples);
  if (!recording.has_sigma)
    for (WheelSample& sample : samples_) sample.sigma.setZero();
  config_ = config;
  next_ = priors_ = 0;
  before_ns_.reset();
  held_s_.reset();
  return {};
}

bool WheelPriors::add(const WheelSample& sample) {
  if (!sample.velocity.allFinite() || !sample.sigma.allFinite()) return false;
  if (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns) return false;
  if (samples_.size() >= kMostSamples) {
    constexpr std::size_t kForgotten = kMostSamples / 2;
    samples_.erase(samples_.begin(), samples_.begin() + kForgotten);
    next_ -= std::min(next_, kForgotten);
  }
  samples_.push_back(sample);
  return true;
}

std::optional<std::int64_t> WheelPriors::last_ns() const {
  return samples_.empty() ? std::nullopt : std::optional(samples_.back().stamp_ns);
}

Matrix6 WheelPriors::covariance_between(const WheelSample& a, const WheelSample& b,
                                        const Vector3& velocity) const {
  Vector3 sigma = 0.5 * (a.sigma + b.sigma);
  if (!(sigma.minCoeff() > 0)) {
    const double off_mps = config_.share * velocity.head<2>().norm();
    sigma = {config_.least_mps + off_mps, config_.least_mps + off_mps,
             config_.least_rps + off_mps / config_.track_m + config_.share * std::abs(velocity.z())};
  }
  if (held_s_ && &b == &samples_.back()) {
    const double off_mps = *held_s_ * config_.acceleration_mps2;
    const double off_rps = *held_s_ * config_.acceleration_rps2;
    sigma = {std::hypot(sigma.x(), off_mps), std::hypot(sigma.y(), off_mps), std::hypot(sigma.z(), off_rps)};
  }
  Vector6 all;
  all << sigma.x(), sigma.y(), config_.bounce_mps, config_.tilt_rps, config_.tilt_rps, sigma.z();
  return all.cwiseProduct(all).asDiagonal();
}

// Whether there are samples from one at or before from_ns to one at or after to_ns, without a gap.
bool WheelPriors::covers(std::size_t first, std::int64_t from_ns, std::int64_t to_ns) const {
  if (first >= samples_.size() || samples_[first].stamp_ns > from_ns) return false;
  for (std::size_t i = first; i + 1 < samples_.size(); ++i) {
    if (wheel_seconds(samples_[i].stamp_ns, samples_[i + 1].stamp_ns) > config_.longest_gap_s) return false;
    if (samples_[i + 1].stamp_ns >= to_ns) return true;
  }
  return false;
}

MotionPrior WheelPriors::prior(std::int64_t stamp_ns) {
  const std::optional<std::int64_t> before_ns = std::exchange(before_ns_, stamp_ns);
  if (!before_ns || stamp_ns <= *before_ns) return {};
  while (next_ + 1 < samples_.size() && samples_[next_ + 1].stamp_ns <= *before_ns) ++next_;
  if (!samples_.empty() && samples_.back().stamp_ns < stamp_ns) {
    const double missing_s = wheel_seconds(samples_.back().stamp_ns, stamp_ns);
    if (missing_s <= config_.hold_s) {
      held_s_ = missing_s;
      samples_.push_back(samples_.back());
      samples_.back().stamp_ns = stamp_ns;
    }
  }
  const MotionPrior prior = prior_between(*before_ns, stamp_ns);
  if (held_s_) samples_.pop_back();
  held_s_.reset();
  return prior;
}

MotionPrior WheelPriors::prior_between(std::int64_t from_ns, std::int64_t to_ns) {
  if (!covers(next_, from_ns, to_ns)) return {};
  BaseMotion motion;
  for (std::size_t i = next_; samples_[i].stamp_ns < to_ns; ++i) {
    const WheelSample &a = samples_[i], &b = samples_[i + 1];
    const std::int64_t begin_ns = std::max(a.stamp_ns, from_ns), end_ns = std::min(b.stamp_ns, to_ns);
    const Vector3 v = 0.5 * (velocity_at(a, b, begin_ns) + velocity_at(a, b, end_ns));
    WheelStep step{wheel_seconds(begin_ns, end_ns), Vector6::Zero(), covariance_between(a, b, v)};
    step.twist << v.x(), v.y(), 0, 0, 0, v.z();
    if (!motion.add(step, config_.error_s).ok()) return {};
  }
  MotionPrior prior;
  if (motion.prior(config_.T_base_camera, prior).ok()) ++priors_;
  return prior;
}

}  // namespace plvo
