// SPDX-License-Identifier: Apache-2.0
// From the samples of a gyro and an accelerometer to the prior of a frame. Samples may come ahead of the
// frames: they wait in the caller's memory.
//
//   plvo::ImuIntegrator imu;
//   plvo::Status status = imu.init(gyro_memory, accelerometer_memory, plvo::ImuConfig{});
//   … imu.add_gyro({stamp_ns, rate}); imu.add_acceleration({stamp_ns, force}); …
//   plvo::MotionPrior prior = imu.prior(frame.stamp_ns);       // for each frame, in their order
//   plvo::TrackResult result = odometry.track(frame, prior);
//   imu.learn(result);
//
// The gyro's rates are taken for linear between samples and integrated from frame to frame (Forster et al.,
// "On-Manifold Preintegration for Real-Time Visual–Inertial Odometry", 2017, without the accelerometer's
// part); its offset is a state of its own that learn() estimates. The accelerometer's mean over the interval
// says where down is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/inertial/imu_config.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo {

// rad/s (gyro) or m/s² (accelerometer: specific force, at rest 9.8 upwards), in the sensor's axes.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Vector3 value = Vector3::Zero();
};

// The samples that wait, oldest first, in a ring of the caller's memory; a full ring drops the oldest.
class SampleRing {
 public:
  SampleRing() = default;
  explicit SampleRing(std::span<ImuSample> memory) : memory_(memory) {}
  // False, and nothing changes, for a sample that is not later than the one before or not finite.
  bool push(const ImuSample& sample);
  void pop() {
    first_ = (first_ + 1) % memory_.size();
    --count_;
  }
  std::size_t size() const { return count_; }
  const ImuSample& operator[](std::size_t i) const { return memory_[(first_ + i) % memory_.size()]; }

 private:
  std::span<ImuSample> memory_;
  std::size_t first_ = 0, count_ = 0;
};

class ImuIntegrator {
 public:
  // The memory holds what comes in between two calls of prior(): 0.2 s at 200 Hz is 40 samples; at least two
  // each, or none for a sensor that is not there. kInvalidArgument for less, or for the config.
  Status init(std::span<ImuSample> gyro, std::span<ImuSample> accelerometer, const ImuConfig& config = {});

  // In the order of their stamps, which count on the clock of the frames. False for a sample that is refused:
  // not later than the one before, or not finite.
  bool add_gyro(const ImuSample& sample) { return gyro_.push(sample); }
  bool add_acceleration(const ImuSample& sample) { return accelerometer_.push(sample); }

  // Of the frame at this stamp, since the frame of the call before. Without rotation at the first call, and
  // where samples are missing; without gravity where the accelerometer said nothing.
  MotionPrior prior(std::int64_t stamp_ns);

  // What became of the frame of the last prior: where it was tracked with it, the gyro's offset is learnt.
  void learn(const TrackResult& result);

  const Vector3& gyro_offset() const { return offset_; }             // rad/s, in the sensor's axes
  const Vector3& gyro_offset_variance() const { return variance_; }  // of each axis

 private:
  bool integrate(std::int64_t from_ns, std::int64_t to_ns, Vector3& angle);
  bool mean_force(std::int64_t from_ns, std::int64_t to_ns, Vector3& force, int& count);
  RotationPrior rotation(double seconds, const Vector3& angle);

  ImuConfig config_;
  Matrix3 turn_ = Matrix3::Identity();  // of rates, which keep their sense in axes of another hand
  SampleRing gyro_, accelerometer_;
  bool started_ = false;
  std::int64_t last_ns_ = 0, before_ns_ = 0;  // of the last call of prior(), and of the one before
  Matrix3 R_now_before_ = Matrix3::Identity();
  Vector3 offset_ = Vector3::Zero(), variance_ = Vector3::Zero();
  // Of the last prior with a rotation, until learn() has used it.
  bool open_ = false;
  double seconds_ = 0;
  RotationPrior last_rotation_;
  // Of the last frame that was seen.
  std::int64_t seen_ns_ = 0, reference_ns_ = 0;
  Matrix3 R_seen_reference_ = Matrix3::Identity();
  bool has_seen_ = false;
};

}  // namespace plvo
