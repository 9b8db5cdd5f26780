// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/recorded_wheels.hpp"

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
  return {};
}

Status RecordedWheels::init(WheelRecording recording, const WheelConfig& config) {
  if (Status status = config.validate(); !status.ok()) return status;
  recording_ = std::move(recording);
  config_ = config;
  next_ = priors_ = 0;
  before_ns_.reset();
  return {};
}

Matrix6 RecordedWheels::covariance_between(const WheelSample& a, const WheelSample& b,
                                           const Vector3& velocity) const {
  Vector3 sigma = 0.5 * (a.sigma + b.sigma);
  if (!recording_.has_sigma) {
    const double off_mps = config_.share * velocity.head<2>().norm();
    sigma = {config_.least_mps + off_mps, config_.least_mps + off_mps,
             config_.least_rps + off_mps / config_.track_m + config_.share * std::abs(velocity.z())};
  }
  Vector6 all;
  all << sigma.x(), sigma.y(), config_.bounce_mps, config_.tilt_rps, config_.tilt_rps, sigma.z();
  return all.cwiseProduct(all).asDiagonal();
}

// Whether there are samples from one at or before from_ns to one at or after to_ns, without a gap.
bool RecordedWheels::covers(std::size_t first, std::int64_t from_ns, std::int64_t to_ns) const {
  const std::vector<WheelSample>& samples = recording_.samples;
  if (first >= samples.size() || samples[first].stamp_ns > from_ns) return false;
  for (std::size_t i = first; i + 1 < samples.size(); ++i) {
    if (wheel_seconds(samples[i].stamp_ns, samples[i + 1].stamp_ns) > config_.longest_gap_s) return false;
    if (samples[i + 1].stamp_ns >= to_ns) return true;
  }
  return false;
}

MotionPrior RecordedWheels::prior(std::int64_t stamp_ns) {
  const std::optional<std::int64_t> before_ns = std::exchange(before_ns_, stamp_ns);
  const std::vector<WheelSample>& samples = recording_.samples;
  if (!before_ns || stamp_ns <= *before_ns) return {};
  while (next_ + 1 < samples.size() && samples[next_ + 1].stamp_ns <= *before_ns) ++next_;
  if (!covers(next_, *before_ns, stamp_ns)) return {};
  BaseMotion motion;
  for (std::size_t i = next_; samples[i].stamp_ns < stamp_ns; ++i) {
    const WheelSample &a = samples[i], &b = samples[i + 1];
    const std::int64_t begin_ns = std::max(a.stamp_ns, *before_ns), end_ns = std::min(b.stamp_ns, stamp_ns);
    const Vector3 v = 0.5 * (velocity_at(a, b, begin_ns) + velocity_at(a, b, end_ns));
    WheelStep step{wheel_seconds(begin_ns, end_ns), Vector6::Zero(), covariance_between(a, b, v)};
    step.twist << v.x(), v.y(), 0, 0, 0, v.z();
    if (!motion.add(step, config_.error_s).ok()) return {};
  }
  MotionPrior prior;
  if (motion.prior(config_.T_base_camera, prior).ok()) ++priors_;
  return prior;
}

double RecordedWheels::largest_speed() const {
  double most = 0;
  for (const WheelSample& sample : recording_.samples)
    most = std::max(most, sample.velocity.head<2>().norm());
  return most;
}

double RecordedWheels::largest_turn_rate() const {
  double most = 0;
  for (const WheelSample& sample : recording_.samples) most = std::max(most, std::abs(sample.velocity.z()));
  return most;
}

}  // namespace plvo
