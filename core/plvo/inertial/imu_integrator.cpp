// SPDX-License-Identifier: Apache-2.0
#include "plvo/inertial/imu_integrator.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/covariance.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// No camera moves like this: a larger value is not a reading of a gyro or an accelerometer.
constexpr double kMostReading = 1e4;
constexpr double kLeastSeconds = 1e-4;
// Bound on the accelerometer's offset, as a share of g.
constexpr double kMostOffset = 0.5;
// Two unit vectors differ by at most 2, so the mean square of each component of a direction's error is at
// most 4.
constexpr double kMostDirectionVariance = 4;
// Bound on the variance of a gyro's offset, (rad/s)²: the largest initial one that ImuConfig allows. The
// random walk does not exceed it.
constexpr double kMostOffsetVariance = 1;
// Differences of stamps within this bound fit into 64 bits.
constexpr std::int64_t kFarthest_ns = std::int64_t{1} << 61;
bool is_stamp(std::int64_t ns) { return ns >= -kFarthest_ns && ns <= kFarthest_ns; }
// Bound on the difference between the rotations by vision and by the gyro over a run, in standard deviations.
// A larger difference is scaled down to the bound.
constexpr double kMostSigmas = 5;

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

// Interpolates linearly between two samples.
Vector3 value_at(const ImuSample& a, const ImuSample& b, std::int64_t stamp_ns) {
  const double u = seconds_between(a.stamp_ns, stamp_ns) / seconds_between(a.stamp_ns, b.stamp_ns);
  return a.value + u * (b.value - a.value);
}

}  // namespace

bool SampleRing::push(const ImuSample& sample) {
  if (memory_.empty() || !(sample.value.cwiseAbs().maxCoeff() <= kMostReading) || !sample.value.allFinite())
    return false;
  if (!is_stamp(sample.stamp_ns)) return false;
  if (count_ > 0 && sample.stamp_ns <= (*this)[count_ - 1].stamp_ns) return false;
  if (count_ == memory_.size()) pop();
  memory_[(first_ + count_) % memory_.size()] = sample;
  ++count_;
  return true;
}

Status ImuIntegrator::init(std::span<ImuSample> gyro, std::span<ImuSample> accelerometer,
                           const ImuConfig& config) {
  if (Status status = config.validate(); !status.ok()) return status;
  if (gyro.size() == 1 || accelerometer.size() == 1)
    return {StatusCode::kInvalidArgument,
            "imu: the memory must hold at least two samples of a sensor, or none"};
  *this = ImuIntegrator();
  config_ = config;
  turn_ = config.R_camera_imu.determinant() < 0 ? Matrix3(-config.R_camera_imu) : config.R_camera_imu;
  gyro_ = SampleRing(gyro);
  accelerometer_ = SampleRing(accelerometer);
  variance_.setConstant(config.gyro_offset_sigma * config.gyro_offset_sigma);
  return {};
}

// Integrates R_now_before_ and the angle of rotation about each axis, which the scale error needs. Keeps the
// last sample at or before `to`, where the next interval continues. Returns false where samples are missing.
bool ImuIntegrator::integrate(std::int64_t from_ns, std::int64_t to_ns, Vector3& angle) {
  Matrix3 R_before_now = Matrix3::Identity();
  angle.setZero();
  std::int64_t done_ns = from_ns;
  bool whole = gyro_.size() > 0 && gyro_[0].stamp_ns <= from_ns;
  while (gyro_.size() > 1 && gyro_[0].stamp_ns <= to_ns) {
    const ImuSample& a = gyro_[0];
    const ImuSample& b = gyro_[1];
    whole = whole && seconds_between(a.stamp_ns, b.stamp_ns) <= config_.longest_gap_s;
    const std::int64_t begin_ns = std::max(a.stamp_ns, done_ns), end_ns = std::min(b.stamp_ns, to_ns);
    if (begin_ns < end_ns) {
      const Vector3 rate = 0.5 * (value_at(a, b, begin_ns) + value_at(a, b, end_ns)) - offset_;
      const Vector3 step = seconds_between(begin_ns, end_ns) * rate;
      R_before_now = R_before_now * rotation_exp(turn_ * step);
      angle += step.cwiseAbs();
      done_ns = end_ns;
    }
    if (b.stamp_ns > to_ns) break;
    gyro_.pop();
  }
  // The last samples may not have arrived yet: the rate is taken as constant.
  if (done_ns < to_ns && gyro_.size() > 0 && gyro_[0].stamp_ns <= done_ns) {
    const double seconds = seconds_between(done_ns, to_ns);
    whole = whole && seconds_between(gyro_[0].stamp_ns, to_ns) <= config_.longest_gap_s;
    const Vector3 step = seconds * (gyro_[0].value - offset_);
    R_before_now = R_before_now * rotation_exp(turn_ * step);
    angle += step.cwiseAbs();
    done_ns = to_ns;
  }
  R_now_before_ = R_before_now.transpose();
  return whole && done_ns == to_ns;
}

// Takes the mean of the samples after `from` up to `to`, and removes them.
bool ImuIntegrator::mean_force(std::int64_t from_ns, std::int64_t to_ns, Vector3& force, int& count) {
  force.setZero();
  count = 0;
  while (accelerometer_.size() > 0 && accelerometer_[0].stamp_ns <= to_ns) {
    if (accelerometer_[0].stamp_ns > from_ns) {
      force += accelerometer_[0].value;
      ++count;
    }
    accelerometer_.pop();
  }
  if (count > 0) force /= count;
  return count > 0;
}

RotationPrior ImuIntegrator::rotation(double seconds, const Vector3& angle) const {
  RotationPrior prior;
  prior.R_now_before = renormalise(R_now_before_);
  Vector3 variance;
  for (int i = 0; i < 3; ++i) {
    const double scale = config_.gyro_scale_sigma * angle[i];
    variance[i] = config_.gyro_noise * config_.gyro_noise * seconds + variance_[i] * seconds * seconds +
                  scale * scale + 1e-14;
  }
  const Matrix3& R = turn_;
  prior.covariance = R * variance.asDiagonal() * R.transpose();
  prior.covariance = symmetric<3>(prior.covariance);
  return prior;
}

MotionPrior ImuIntegrator::prior(std::int64_t stamp_ns) {
  MotionPrior prior;
  const bool first = !started_;
  const std::int64_t before_ns = last_ns_;
  has_rotation_ = false;
  if (!is_stamp(stamp_ns) || (!first && stamp_ns <= before_ns)) return prior;
  started_ = true;
  before_ns_ = before_ns;
  last_ns_ = stamp_ns;
  seconds_ = first ? 0 : seconds_between(before_ns, stamp_ns);
  for (int i = 0; i < 3; ++i) {
    const double wandered = config_.gyro_offset_walk * config_.gyro_offset_walk * seconds_;
    variance_[i] += std::clamp(kMostOffsetVariance - variance_[i], 0.0, wandered);
  }
  Vector3 angle;
  // Without a previous frame, the samples of the last moment still give the direction of gravity.
  constexpr std::int64_t kMoment_ns = 100'000'000;
  const std::int64_t from_ns = first ? stamp_ns - kMoment_ns : before_ns;
  const bool whole = integrate(from_ns, stamp_ns, angle);
  if (whole && !first && seconds_ > kLeastSeconds) {
    const RotationPrior found = rotation(seconds_, angle);
    // A rotation whose variance exceeds the bound carries no information.
    has_rotation_ = found.covariance.diagonal().maxCoeff() <= kMostRotationVariance;
    if (has_rotation_) prior.rotation = found;
  }
  Vector3 force;
  int count = 0;
  if (!mean_force(from_ns, stamp_ns, force, count)) return prior;
  const double force_squared = force.squaredNorm();
  // A specific force far from g means that the sensor is thrown or dropped; it gives no direction of gravity.
  if (!(force_squared > 0.25 * kStandardGravity * kStandardGravity &&
        force_squared < 4 * kStandardGravity * kStandardGravity))
    return prior;
  const double interval = first ? 0.1 : std::max(seconds_, kLeastSeconds);
  // An acceleration that lasts longer than the interval affects several readings; their variance is larger by
  // that factor.
  const double go = std::max(1.0, 2 * config_.acceleration_s / interval);
  const double variance = (config_.accelerometer_noise * config_.accelerometer_noise / interval +
                           config_.acceleration * config_.acceleration * go) /
                          (kStandardGravity * kStandardGravity);
  GravityPrior gravity;
  gravity.down = -(config_.R_camera_imu * force);
  gravity.covariance = Matrix3::Identity() * std::clamp(variance, 1e-12, kMostDirectionVariance);
  gravity.offset_sigma = std::min(config_.accelerometer_offset_sigma / kStandardGravity, kMostOffset);
  prior.gravity = gravity;
  return prior;
}

void ImuIntegrator::start_run(const ObservedRotation& first) {
  run_ = {first, first, 0, Matrix3::Identity(), Matrix3::Zero()};
  has_run_ = true;
}

// Covariance of the rotation by the gyro minus that by vision, without the part of the offset. The errors of
// vision at the ends of the run are taken as independent; that of the reference itself is zero.
Matrix3 ImuIntegrator::noise_of_run() const {
  const Vector3 angle = turn_.transpose() * rotation_log(run_.R_last_first);
  Vector3 variance;
  for (int i = 0; i < 3; ++i) {
    const double scale = config_.gyro_scale_sigma * angle[i];
    variance[i] = config_.gyro_noise * config_.gyro_noise * run_.seconds + scale * scale;
  }
  const Matrix3 R_last_first = run_.R_last_first;
  return turn_ * variance.asDiagonal() * turn_.transpose() + run_.last.covariance +
         R_last_first * run_.first.covariance * R_last_first.transpose();
}

Matrix3 ImuIntegrator::offset_error_of_run() const {
  return run_.derivative * variance_.asDiagonal() * run_.derivative.transpose();
}

// A step of a Kalman filter whose state is the offset. Only the variances of the axes are kept.
void ImuIntegrator::finish_run() {
  const Matrix3 S = noise_of_run() + offset_error_of_run();
  Cholesky<3> cholesky;
  if (!cholesky.factor(symmetric<3>(S))) return;
  const Matrix3 inverse = cholesky.inverse();
  const Matrix3 R_by_vision = run_.last.R_camera_reference * run_.first.R_camera_reference.transpose();
  Vector3 e = rotation_log(R_by_vision * run_.R_last_first.transpose());
  const double sigmas = sqrt(e.dot(Vector3(inverse * e)));
  if (sigmas > kMostSigmas) e *= kMostSigmas / sigmas;
  const Matrix3 gain = variance_.asDiagonal() * run_.derivative.transpose() * inverse;
  const Matrix3 left = Matrix3::Identity() - gain * run_.derivative;
  offset_ += gain * e;
  for (int i = 0; i < 3; ++i) variance_[i] *= std::clamp(left(i, i), 0.0, 1.0);
}

// A run ends with its reference, or as soon as it determines the offset better than it is known.
void ImuIntegrator::correct(const ObservedRotation& observed) {
  const bool starts = observed.reference_stamp_ns == observed.stamp_ns;
  if (starts || !has_run_ || !has_rotation_ || run_.last.stamp_ns != before_ns_ ||
      observed.stamp_ns != last_ns_) {
    start_run(observed);
    return;
  }
  if (observed.reference_stamp_ns != run_.last.reference_stamp_ns) {
    const bool goes_on = observed.reference_stamp_ns == run_.last.stamp_ns;
    ObservedRotation reference = run_.last;
    finish_run();
    if (!goes_on) {
      start_run(observed);
      return;
    }
    reference.reference_stamp_ns = reference.stamp_ns;
    reference.R_camera_reference.setIdentity();
    reference.covariance.setZero();
    start_run(reference);
  }
  const Matrix3& R_now_before = R_now_before_;
  run_.last = observed;
  run_.seconds += seconds_;
  run_.R_last_first = renormalise(R_now_before * run_.R_last_first);
  run_.derivative = R_now_before * run_.derivative + seconds_ * turn_;
  if (offset_error_of_run().trace() < noise_of_run().trace()) return;
  finish_run();
  start_run(observed);
}

}  // namespace plvo
