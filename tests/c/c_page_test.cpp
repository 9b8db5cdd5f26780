// SPDX-License-Identifier: Apache-2.0
// The functions of docs/user/c.md, compiled as C11, give the bits of C++.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "c_support.hpp"
#include "moving_imu.hpp"
#include "page_functions.h"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/motion/wheel_prior.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

struct CPage : testing::Test {
  void SetUp() override {
    camera = c_camera(sequence.camera());
    const plvo_limits limits = c_limits(Limits::tiny());
    block.resize(plvo_required_bytes(&limits));
    const plvo_status status = plvo_init(block.data(), block.size(), &camera, nullptr, &limits, &c_odometry);
    EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT) << "the default matches with two frames";
    config.preset = PLVO_PRESET_TINY;
    config.struct_size = sizeof config;
    config.seed = Config().seed;
    ASSERT_EQ(plvo_init(block.data(), block.size(), &camera, &config, &limits, &c_odometry).code, PLVO_OK);
    start(Config::tiny());
  }
  void start(const Config& with) {
    memory.resize(required_bytes(Limits::tiny()));
    ASSERT_TRUE(odometry.init(memory, sequence.camera(), with, Limits::tiny()).ok());
  }

  ProceduralSequence sequence{320, 240};
  plvo_camera camera = {};
  plvo_config config = {};
  std::vector<std::byte> block, memory;
  plvo_odometry* c_odometry = nullptr;
  Odometry odometry;
};

TEST_F(CPage, StartsTinyAndTracksInTime) {
  Config budgeted = Config::tiny();
  budgeted.budget.frame_ns = 50'000'000;
  start(budgeted);
  plvo_odometry* tiny = nullptr;
  const plvo_status status = start_tiny(&camera, &tiny);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  plvo_result result = {};
  result.struct_size = sizeof result;
  for (int i = 0; i < 6; ++i) {
    const RgbdFrame frame = sequence.render(i);
    const plvo_frame view = c_frame(frame);
    EXPECT_EQ(track_in_time(tiny, &view, &result).code, PLVO_OK);
    expect_same(odometry.track(frame), result);
    odometry.frame_took(60'000'000);
  }
  EXPECT_EQ(result.feature_step, 2) << "every frame took 60 ms";
}

TEST_F(CPage, TracksWithARotation) {
  for (int i = 0; i < 4; ++i) {
    const RgbdFrame frame = i == 3 ? sequence.render_dark(i) : sequence.render(i);
    const Matrix3 R_now_before = i == 0 ? Matrix3(Matrix3::Identity())
                                        : ProceduralSequence::T_world_camera(i).R.transpose() *
                                              ProceduralSequence::T_world_camera(i - 1).R;
    double R[9];
    for (int k = 0; k < 9; ++k) R[k] = R_now_before(k / 3, k % 3);
    MotionPrior prior;
    prior.rotation = {R_now_before, 1e-6 * Matrix3::Identity()};
    const plvo_frame view = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    const plvo_status status = track_turned(c_odometry, &view, R, &result);
    EXPECT_EQ(status.code == PLVO_OK, i < 3);
    EXPECT_EQ(result.state, i == 0 ? PLVO_INITIALISING : (i == 3 ? PLVO_PREDICTED : PLVO_TRACKING));
    expect_same(odometry.track(frame, prior), result);
  }
}

TEST_F(CPage, TracksWithWheels) {
  Matrix3 R_body_optical;
  R_body_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Se3 T_base_camera{R_body_optical, {0.2, 0.1, 0.5}};
  double T[12];
  for (int k = 0; k < 12; ++k) T[k] = k % 4 == 3 ? T_base_camera.t(k / 4) : T_base_camera.R(k / 4, k % 4);
  for (int i = 0; i < 4; ++i) {
    const RgbdFrame frame = i == 3 ? sequence.render_dark(i) : sequence.render(i);
    WheelStep step{1.0 / 30, Vector6::Zero(), 4e-4 * Matrix6::Identity()};
    step.twist[0] = 0.4;
    step.twist[5] = -0.2;
    MotionPrior prior;
    ASSERT_TRUE(wheel_prior({&step, 1}, 0.5, T_base_camera, prior).ok());
    const plvo_frame view = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    (void)track_driven(c_odometry, &view, 1.0 / 30, 0.4, -0.2, T, &result);
    EXPECT_EQ(result.state == PLVO_PREDICTED, i == 3);
    expect_same(odometry.track(frame, prior), result);
  }
}

TEST_F(CPage, InvalidWheelStepsAreRefusedAndChangeNothing) {
  const double T[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  plvo_wheel_step step = {};
  step.seconds = 0.1;
  for (int k = 0; k < 36; k += 7) step.covariance[k] = 1e-4;
  plvo_prior prior;
  plvo_prior_init(&prior, sizeof prior);
  prior.has_gravity = 1;
  const auto refused = [&prior](const plvo_status& status, const char* word) {
    EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT);
    EXPECT_NE(std::string(status.message).find(word), std::string::npos) << status.message;
    EXPECT_EQ(prior.has_rotation + prior.has_translation, 0);
  };
  refused(plvo_wheel_prior(nullptr, 1, 0, T, &prior), "NULL");
  refused(plvo_wheel_prior(&step, 1, 0, nullptr, &prior), "NULL");
  refused(plvo_wheel_prior(&step, 0, 0, T, &prior), "a step at least");
  refused(plvo_wheel_prior(&step, 1, -1, T, &prior), "error_s");
  step.covariance[7] = 0;
  refused(plvo_wheel_prior(&step, 1, 0, T, &prior), "positive definite");
  step.covariance[7] = 1e-4;
  EXPECT_EQ(plvo_wheel_prior(&step, 1, 0, T, &prior).code, PLVO_OK);
  EXPECT_EQ(prior.has_rotation + prior.has_translation + prior.has_gravity, 3) << "gravity stays";
  prior.struct_size = 1;
  EXPECT_NE(plvo_wheel_prior(&step, 1, 0, T, &prior).code, PLVO_OK);
}

// plvo_config.level_world, which joined the struct last: the first pose waits for gravity.
TEST_F(CPage, FirstPoseWaitsForGravityWhenTheWorldIsLevel) {
  Config level = Config::tiny();
  level.level_world = true;
  start(level);
  config.level_world = 1;
  const plvo_limits limits = c_limits(Limits::tiny());
  ASSERT_EQ(plvo_init(block.data(), block.size(), &camera, &config, &limits, &c_odometry).code, PLVO_OK);
  for (int i = 0; i < 4; ++i) {
    const RgbdFrame frame = sequence.render(i);
    MotionPrior prior;
    plvo_prior c_prior;
    plvo_prior_init(&c_prior, sizeof c_prior);
    if (i > 0) {
      prior.gravity = {Vector3(0.2, 0.9, 0.1), 1e-4 * Matrix3::Identity(), 0.02};
      c_prior.has_gravity = 1;
      for (int k = 0; k < 3; ++k) c_prior.down[k] = prior.gravity->down[k];
      for (int k = 0; k < 9; k += 4) c_prior.gravity_covariance[k] = 1e-4;
      c_prior.gravity_offset_sigma = 0.02;
    }
    const plvo_frame view = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    const plvo_status status = plvo_track_with_prior(c_odometry, &view, &c_prior, &result);
    EXPECT_EQ(status.code, i == 0 ? PLVO_NOT_FOUND : PLVO_OK) << status.message;
    expect_same(odometry.track(frame, prior), result);
    if (i == 1) {
      EXPECT_NEAR(result.T_world_camera[5], 0.9 / Vector3(0.2, 0.9, 0.1).norm(), 1e-12) << "R(1, 1)";
    }
  }
}

// The same samples: the same poses and offset, to the last bit.
TEST_F(CPage, TracksWithAGyroAndAnAccelerometer) {
  std::vector<ImuSample> gyro(128), accelerometer(128);
  ImuIntegrator imu;
  ASSERT_TRUE(imu.init(gyro, accelerometer, {}).ok());
  plvo_imu* c_imu = nullptr;
  const plvo_status started = start_imu(&c_imu);
  ASSERT_EQ(started.code, PLVO_OK) << started.message;
  for (int i = 0; i < 10; ++i) {
    for (const ImuReading& reading : imu_readings(i)) {
      EXPECT_TRUE(imu.add_gyro({reading.stamp_ns, reading.rate}));
      EXPECT_TRUE(imu.add_acceleration({reading.stamp_ns, reading.force}));
      on_sample(c_imu, reading.stamp_ns, reading.rate.data(), reading.force.data());
    }
    const RgbdFrame frame = i == 6 ? sequence.render_dark(i) : sequence.render(i);
    const TrackResult expected = odometry.track(frame, imu);
    const plvo_frame view = c_frame(frame);
    plvo_result result = {};
    result.struct_size = sizeof result;
    track_with_imu(c_odometry, c_imu, &view, &result);
    EXPECT_EQ(result.state, i == 0 ? PLVO_INITIALISING : (i == 6 ? PLVO_PREDICTED : PLVO_TRACKING)) << i;
    expect_same(expected, result);
    double offset[3], variance[3];
    ASSERT_EQ(plvo_imu_gyro_offset(c_imu, offset, variance).code, PLVO_OK);
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(same_bits(offset[k], imu.gyro_offset()[k]));
      EXPECT_TRUE(same_bits(variance[k], imu.gyro_offset_variance()[k]));
    }
  }
  EXPECT_GT(imu.gyro_offset().norm(), 1e-3) << "there was something to learn";
}

}  // namespace
}  // namespace plvo
