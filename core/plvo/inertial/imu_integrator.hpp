// SPDX-License-Identifier: Apache-2.0
// Turns the samples of a gyro and an accelerometer into the prior of a frame. Samples may arrive ahead of the
// frames: they wait in the caller's memory.
//
//   plvo::ImuIntegrator imu;
//   plvo::Status status = imu.init(gyro_memory, accelerometer_memory, plvo::ImuConfig{});
//   … imu.add_gyro({stamp_ns, rate}); imu.add_acceleration({stamp_ns, force}); …
//   plvo::TrackResult result = odometry.track(frame, imu);     // for each frame, in their order
//
// The gyro's rates are taken as linear between samples and integrated from frame to frame (Forster et al.,
// "On-Manifold Preintegration for Real-Time Visual–Inertial Odometry", 2017, without the accelerometer's
// part). The gyro's offset is a separate state that correct() estimates. The accelerometer's mean over the
// interval gives the direction of gravity.
//
// The offset is observable in the rotation over several frames. Between neighbouring frames its effect is
// less than the error of vision, and the errors of neighbouring frames are not independent, because both are
// matched with the same reference. So correct() compares the rotation by the gyro with that by vision over a
// run of frames with one reference, and uses each run once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "plvo/inertial/imu_config.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/motion_prior.hpp"

namespace plvo {

// rad/s (gyro) or m/s² (accelerometer: specific force, at rest 9.8 upwards), in the sensor's axes.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Vector3 value = Vector3::Zero();
};

// Waiting samples, oldest first, in a ring of the caller's memory; a full ring drops the oldest.
class SampleRing {
 public:
  SampleRing() = default;
  explicit SampleRing(std::span<ImuSample> memory) : memory_(memory) {}
  // Returns false, and changes nothing, for a sample that is not later than the one before or not finite.
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

// The rotation of a frame that was tracked, or of one that starts a trajectory: its own stamp is then that of
// the reference.
struct ObservedRotation {
  std::int64_t stamp_ns = 0, reference_stamp_ns = 0;
  Matrix3 R_camera_reference = Matrix3::Identity();
  Matrix3 covariance = Matrix3::Zero();  // rad², in the camera's axes
};

class ImuIntegrator {
 public:
  // The memory holds the samples between two calls of prior(): 0.2 s at 200 Hz is 40 samples. It must hold at
  // least two of each sensor, or none for a missing sensor. Returns kInvalidArgument for less, or for an
  // invalid config.
  Status init(std::span<ImuSample> gyro, std::span<ImuSample> accelerometer, const ImuConfig& config = {});

  // Takes samples in the order of their stamps, which use the clock of the frames. Returns false for a
  // refused sample: not later than the one before, or not finite.
  bool add_gyro(const ImuSample& sample) { return gyro_.push(sample); }
  bool add_acceleration(const ImuSample& sample) { return accelerometer_.push(sample); }

  // Prior of the frame at this stamp, since the frame of the previous call. It has no rotation at the first
  // call or where samples are missing, and no gravity where the accelerometer gave none.
  MotionPrior prior(std::int64_t stamp_ns);

  // Takes the rotation of the frame of the last prior, and corrects the gyro's offset where a run of frames
  // ends. Odometry::track(frame, imu) calls it for every tracked frame.
  void correct(const ObservedRotation& observed);

  const Vector3& gyro_offset() const { return offset_; }             // rad/s, in the sensor's axes
  const Vector3& gyro_offset_variance() const { return variance_; }  // of each axis

 private:
  bool integrate(std::int64_t from_ns, std::int64_t to_ns, Vector3& angle);
  bool mean_force(std::int64_t from_ns, std::int64_t to_ns, Vector3& force, int& count);
  RotationPrior rotation(double seconds, const Vector3& angle) const;
  // Frames with one reference, from `first` to `last`, and the gyro's rotation between the two.
  struct Run {
    ObservedRotation first, last;
    double seconds = 0;
    Matrix3 R_last_first = Matrix3::Identity();  // by the gyro
    // Derivative of the rotation (in the camera's axes at `last`) with respect to the offset's error, in s.
    Matrix3 derivative = Matrix3::Zero();
  };
  void start_run(const ObservedRotation& first);
  Matrix3 noise_of_run() const;
  Matrix3 offset_error_of_run() const;
  void finish_run();

  ImuConfig config_;
  // For rates, which are axial vectors: a rotation also if the axes have another handedness
  Matrix3 turn_ = Matrix3::Identity();
  SampleRing gyro_, accelerometer_;
  bool started_ = false;
  std::int64_t last_ns_ = 0, before_ns_ = 0;  // of the last call of prior(), and of the one before
  Matrix3 R_now_before_ = Matrix3::Identity();
  Vector3 offset_ = Vector3::Zero(), variance_ = Vector3::Zero();
  double seconds_ = 0;         // of the last prior
  bool has_rotation_ = false;  // the last prior
  bool has_run_ = false;
  Run run_;
};

}  // namespace plvo
