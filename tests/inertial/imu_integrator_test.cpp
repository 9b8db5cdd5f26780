// SPDX-License-Identifier: Apache-2.0
// Priors from samples: compared with rotations that are integrated in a hundred times finer steps, with noise
// and offsets as stated, with missing samples, and with invalid input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;

constexpr double kGravity = 9.80665;
constexpr std::int64_t kSecond = 1'000'000'000;

// Angular velocity of a hand-held camera, rad/s, in the camera's axes.
Vector3 rate(double t) {
  return {0.8 * std::sin(5 * t), 0.6 * std::cos(3 * t) + 0.2, 0.5 * std::sin(7 * t + 1)};
}

// R_from_to, integrated in steps of 20 µs.
Matrix3 slow_reference(double from_s, double to_s) {
  Matrix3 R = Matrix3::Identity();
  const int steps = static_cast<int>((to_s - from_s) * 5e4 + 0.5);
  for (int k = 0; k < steps; ++k) {
    const double dt = (to_s - from_s) / steps;
    R = R * rotation_exp(Vector3(dt * rate(from_s + (k + 0.5) * dt)));
  }
  return R;
}

struct Imu {
  explicit Imu(const ImuConfig& config = {}, std::size_t samples = 256)
      : gyro(samples), accelerometer(samples) {
    status = integrator.init(gyro, accelerometer, config);
  }
  // Samples at 200 Hz in (from, to].
  template <typename Noise>
  void feed(double from_s, double to_s, Noise noise) {
    for (int k = static_cast<int>(from_s * 200) + 1; k <= static_cast<int>(to_s * 200 + 1e-9); ++k) {
      EXPECT_TRUE(integrator.add_gyro({k * kSecond / 200, rate(k / 200.0) + noise()}));
      EXPECT_TRUE(integrator.add_acceleration({k * kSecond / 200, {0, -kGravity, 0}}));
    }
  }
  void feed(double from_s, double to_s) {
    feed(from_s, to_s, [] { return Vector3(Vector3::Zero()); });
  }
  std::vector<ImuSample> gyro, accelerometer;
  ImuIntegrator integrator;
  Status status;
};

std::int64_t stamp(double s) { return static_cast<std::int64_t>(std::llround(s * 1e9)); }

TEST(ImuIntegrator, AgreesWithAFineIntegration) {
  Imu imu({}, 1024);
  ASSERT_TRUE(imu.status.ok());
  imu.feed(-0.1, 3.5);
  EXPECT_FALSE(imu.integrator.prior(stamp(0.5)).rotation) << "there is no previous frame";
  // The stamps of frames lie between samples, too.
  for (int i = 1; i < 30; ++i) {
    const double before = 0.5 + (i - 1) * 0.0333, now = 0.5 + i * 0.0333;
    const MotionPrior prior = imu.integrator.prior(stamp(now));
    ASSERT_TRUE(prior.rotation);
    EXPECT_TRUE(prior.validate().ok()) << prior.validate().message();
    const Matrix3 expected = slow_reference(before, now).transpose();
    EXPECT_LT(rotation_log(prior.rotation->R_now_before * expected.transpose()).norm(), 2e-5) << i;
  }
}

// Every prior must pass validate(): track() refuses a frame with its prior.
TEST(ImuIntegrator, GivesValidPriorsForAnyGaps) {
  ImuConfig config;
  config.longest_gap_s = 10;
  config.gyro_offset_walk = 1;
  config.acceleration = 100;
  config.acceleration_s = 100;
  Imu imu(config);
  std::int64_t now_ns = 0;
  for (const std::int64_t step_ns : {kSecond / 30, kSecond / 10'000, 9 * kSecond, std::int64_t{1},
                                     2'000'000'000 * kSecond, kSecond / 30, 9 * kSecond}) {
    for (int k = 0; k <= 3; ++k) {
      const std::int64_t sample_ns = now_ns + k * step_ns / 3;
      (void)imu.integrator.add_gyro({sample_ns, {0.1, 0.2, 0.3}});
      (void)imu.integrator.add_acceleration({sample_ns, {0, -kGravity, 0}});
    }
    now_ns += step_ns;
    const MotionPrior prior = imu.integrator.prior(now_ns);
    EXPECT_TRUE(prior.validate().ok()) << step_ns << " ns: " << prior.validate().message();
    EXPECT_LE(imu.integrator.gyro_offset_variance().maxCoeff(), 1);
  }
}

TEST(ImuIntegrator, CovarianceAgreesWithTheError) {
  ImuConfig config;
  config.gyro_offset_sigma = 0.01;
  config.gyro_offset_walk = 0;
  config.gyro_scale_sigma = 0;
  constexpr double kStep_s = 0.0333;
  double nees = 0;
  constexpr int kTrials = 400;
  Gaussian gaussian(3);
  for (int trial = 0; trial < kTrials; ++trial) {
    Imu imu(config);
    const Vector3 offset = 0.01 * gaussian.vector<3>();
    const double sample_sigma = config.gyro_noise * std::sqrt(200.0);
    imu.feed(-0.1, 0.2, [&] { return Vector3(offset + sample_sigma * gaussian.vector<3>()); });
    (void)imu.integrator.prior(stamp(0.1));
    const MotionPrior prior = imu.integrator.prior(stamp(0.1 + kStep_s));
    const Matrix3 expected = slow_reference(0.1, 0.1 + kStep_s).transpose();
    const Vector3 e = rotation_log(expected * prior.rotation->R_now_before.transpose());
    nees += e.dot(Vector3(prior.rotation->covariance.inverse() * e)) / kTrials;
  }
  EXPECT_NEAR(nees, 3, 0.6);
}

// Learns the offset from observations of 1 mrad SD (which vision makes without the prior). The references
// last for so many frames. Returns the RMSE of the offset as a share of its SD at the start, and the mean
// squared error of an axis over its variance.
struct Learnt {
  double error = 0, nees = 0;
};
Learnt learn_offset(int frames_of_reference) {
  ImuConfig config;
  config.gyro_scale_sigma = 0;
  config.gyro_offset_walk = 0;
  constexpr int kTrials = 60;
  constexpr double kSeen_rad = 1e-3, kFrame_s = 0.0333;
  constexpr int kFrames = 121;
  const auto time = [](int frame) { return 0.1 + frame * kFrame_s; };
  std::vector<Matrix3> truths{Matrix3::Identity()};  // of each frame since the first
  for (int i = 1; i < kFrames; ++i)
    truths.push_back(slow_reference(time(i - 1), time(i)).transpose() * truths.back());
  Gaussian gaussian(5);
  Learnt learnt;
  for (int trial = 0; trial < kTrials; ++trial) {
    Imu imu(config, 1024);
    const Vector3 offset = config.gyro_offset_sigma * gaussian.vector<3>();
    const double sample_sigma = config.gyro_noise * std::sqrt(200.0);
    imu.feed(-0.1, 4.4, [&] { return Vector3(offset + sample_sigma * gaussian.vector<3>()); });
    int reference = 0;
    for (int i = 0; i < kFrames; ++i) {
      (void)imu.integrator.prior(stamp(time(i)));
      if (i - reference > frames_of_reference) reference = i - 1;
      ObservedRotation observed;
      observed.stamp_ns = stamp(time(i));
      observed.reference_stamp_ns = stamp(time(reference));
      if (i > 0) {
        const Matrix3 truth =
            truths[static_cast<std::size_t>(i)] * truths[static_cast<std::size_t>(reference)].transpose();
        observed.R_camera_reference = rotation_exp(Vector3(kSeen_rad * gaussian.vector<3>())) * truth;
        observed.covariance = kSeen_rad * kSeen_rad * Matrix3::Identity();
      }
      imu.integrator.correct(observed);
    }
    const Vector3 off = offset - imu.integrator.gyro_offset();
    const double variance = config.gyro_offset_sigma * config.gyro_offset_sigma;
    learnt.error += off.squaredNorm() / (3 * kTrials * variance);
    for (int axis = 0; axis < 3; ++axis)
      learnt.nees += off[axis] * off[axis] / imu.integrator.gyro_offset_variance()[axis] / (3 * kTrials);
  }
  learnt.error = std::sqrt(learnt.error);
  return learnt;
}

TEST(ImuIntegrator, LearnsTheGyroOffsetAndItsVariance) {
  const Learnt step_by_step = learn_offset(1), by_keyframe = learn_offset(15);
  EXPECT_LT(step_by_step.error, 0.2);
  EXPECT_NEAR(step_by_step.nees, 1, 0.35);
  // Over 15 frames, an error of a rotation is one of a fifteenth of the rate.
  EXPECT_LT(by_keyframe.error, 0.05);
  EXPECT_NEAR(by_keyframe.nees, 1, 0.35);
}

TEST(ImuIntegrator, GivesNoPriorWithoutSamples) {
  Imu imu;
  imu.feed(-0.1, 0.2);
  (void)imu.integrator.prior(stamp(0.1));
  EXPECT_TRUE(imu.integrator.prior(stamp(0.13)).rotation);
  EXPECT_TRUE(imu.integrator.prior(stamp(0.22)).rotation) << "20 ms ahead of the samples";
  EXPECT_FALSE(imu.integrator.prior(stamp(0.40)).rotation) << "180 ms are too long";
  imu.feed(0.5, 0.7);
  EXPECT_FALSE(imu.integrator.prior(stamp(0.60)).rotation) << "a gap of 300 ms";
  EXPECT_TRUE(imu.integrator.prior(stamp(0.63)).rotation);
  // The ring is too small for the interval.
  Imu small({}, 8);
  small.feed(0, 0.1);
  (void)small.integrator.prior(stamp(0.1));
  small.feed(0.1, 0.3);
  EXPECT_FALSE(small.integrator.prior(stamp(0.3)).rotation);
  Imu none({}, 0);
  EXPECT_TRUE(none.status.ok());
  EXPECT_FALSE(none.integrator.add_gyro({1, Vector3::Zero()}));
  (void)none.integrator.prior(1);
  const MotionPrior prior = none.integrator.prior(2);
  EXPECT_FALSE(prior.rotation || prior.gravity);
}

TEST(ImuIntegrator, RefusesInvalidArguments) {
  Imu imu;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(imu.integrator.add_gyro({10, Vector3::Zero()}));
  EXPECT_FALSE(imu.integrator.add_gyro({10, Vector3::Zero()}));
  EXPECT_FALSE(imu.integrator.add_gyro({9, Vector3::Zero()}));
  EXPECT_FALSE(imu.integrator.add_gyro({11, {0, nan, 0}}));
  EXPECT_FALSE(imu.integrator.add_gyro({11, {0, 1e9, 0}}));
  EXPECT_FALSE(imu.integrator.add_gyro({std::numeric_limits<std::int64_t>::max(), Vector3::Zero()}));
  EXPECT_TRUE(imu.integrator.add_gyro({11, Vector3::Zero()}));
  ImuConfig config;
  config.gyro_noise = nan;
  EXPECT_EQ(Imu(config).status.code(), StatusCode::kInvalidArgument);
  config = {};
  config.R_camera_imu(0, 0) = 2;
  EXPECT_EQ(Imu(config).status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Imu({}, 1).status.code(), StatusCode::kInvalidArgument);
  // Stamps whose differences overflow give no prior and change nothing.
  Imu far;
  far.feed(-0.1, 0.2);
  (void)far.integrator.prior(stamp(0.1));
  EXPECT_FALSE(far.integrator.prior(std::numeric_limits<std::int64_t>::max()).rotation);
  EXPECT_FALSE(far.integrator.prior(std::numeric_limits<std::int64_t>::min()).rotation);
  EXPECT_TRUE(far.integrator.prior(stamp(0.13)).rotation);
}

TEST(ImuIntegrator, DownIsOppositeToTheForce) {
  // The sensor's x points down, y right, z forward: left-handed axes.
  ImuConfig config;
  config.R_camera_imu << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  Imu imu(config);
  ASSERT_TRUE(imu.status.ok());
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(imu.integrator.add_acceleration({k * kSecond / 200, {-kGravity, 0, 0}}));
    ASSERT_TRUE(imu.integrator.add_gyro({k * kSecond / 200, {0.5, 0, 0}}));
  }
  MotionPrior prior = imu.integrator.prior(stamp(0.1));
  ASSERT_TRUE(prior.gravity);
  EXPECT_LT((prior.gravity->down.normalized() - Vector3(0, 1, 0)).norm(), 1e-12);
  EXPECT_TRUE(prior.validate().ok());
  // A rotation about the sensor's x is one about the camera's y in the opposite sense, because the handedness
  // differs.
  prior = imu.integrator.prior(stamp(0.2));
  ASSERT_TRUE(prior.rotation);
  EXPECT_LT((rotation_log(prior.rotation->R_now_before) - Vector3(0, 0.05, 0)).norm(), 1e-9);
  // Free fall.
  for (int k = 60; k < 80; ++k)
    ASSERT_TRUE(imu.integrator.add_acceleration({k * kSecond / 200, {0.1, 0, 0}}));
  (void)imu.integrator.prior(stamp(0.3));
  EXPECT_FALSE(imu.integrator.prior(stamp(0.39)).gravity);
}

}  // namespace
}  // namespace plvo
