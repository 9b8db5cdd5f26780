// SPDX-License-Identifier: Apache-2.0
// A gyro and an accelerometer for C: the priors of C++ bit for bit with every entry of the config, without
// memory of their own; nonsense is answered with words.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "allocation_guard.hpp"
#include "c_support.hpp"
#include "moving_imu.hpp"
#include "plvo/c/imu.h"
#include "plvo/c/matrices.hpp"

namespace plvo {
namespace {

plvo_imu_config default_imu_config() {
  plvo_imu_config config;
  plvo_imu_config_init(&config, sizeof config);
  return config;
}

struct CImu : testing::Test {
  plvo_status init(const plvo_imu_config* config, std::size_t offset = 0) {
    const std::size_t needed = plvo_imu_required_bytes(config);
    block.assign((needed == 0 ? 1 : needed) + offset, std::byte{0x5a});
    return plvo_imu_init(block.data() + offset, block.size() - offset, config, &imu);
  }
  void add(int frame) {
    for (const ImuReading& reading : imu_readings(frame)) {
      EXPECT_EQ(plvo_imu_add_gyro(imu, reading.stamp_ns, reading.rate.data()).code, PLVO_OK);
      EXPECT_EQ(plvo_imu_add_acceleration(imu, reading.stamp_ns, reading.force.data()).code, PLVO_OK);
    }
  }
  std::vector<std::byte> block;
  plvo_imu* imu = nullptr;
};

void expect_says(const plvo_status& status, const char* words) {
  EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(status.message, words), nullptr) << status.message;
}

TEST_F(CImu, GivesThePriorsOfCpp) {
  plvo_imu_config c = default_imu_config();
  ImuConfig config;
  config.R_camera_imu << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  config.R_camera_imu = -config.R_camera_imu;  // of the other hand
  c::put(config.R_camera_imu, c.R_camera_imu);
  c.gyro_samples = 7;
  c.accelerometer_samples = 5;
  c.gyro_noise = config.gyro_noise = 1e-3;
  c.gyro_offset_sigma = config.gyro_offset_sigma = 0.03;
  c.gyro_offset_walk = config.gyro_offset_walk = 2e-4;
  c.gyro_scale_sigma = config.gyro_scale_sigma = 0.02;
  c.accelerometer_noise = config.accelerometer_noise = 5e-3;
  c.accelerometer_offset_sigma = config.accelerometer_offset_sigma = 0.2;
  c.acceleration = config.acceleration = 0.7;
  c.acceleration_s = config.acceleration_s = 0.2;
  c.longest_gap_s = config.longest_gap_s = 0.04;
  ASSERT_EQ(init(&c, 5).code, PLVO_OK) << "a block may start anywhere";
  std::vector<ImuSample> gyro(7), accelerometer(5);
  ImuIntegrator expected;
  ASSERT_TRUE(expected.init(gyro, accelerometer, config).ok());
  for (int i = 0; i < 5; ++i) {
    const std::int64_t gap_ns = i == 4 ? 50'000'000 : 0;  // longer than what is let pass
    for (const ImuReading& reading : imu_readings(i)) {
      EXPECT_TRUE(expected.add_gyro({reading.stamp_ns + gap_ns, reading.rate}));
      EXPECT_TRUE(expected.add_acceleration({reading.stamp_ns + gap_ns, reading.force}));
      EXPECT_EQ(plvo_imu_add_gyro(imu, reading.stamp_ns + gap_ns, reading.rate.data()).code, PLVO_OK);
      EXPECT_EQ(plvo_imu_add_acceleration(imu, reading.stamp_ns + gap_ns, reading.force.data()).code,
                PLVO_OK);
    }
    const std::int64_t stamp_ns = ProceduralSequence::stamp_ns(i) + gap_ns;
    const MotionPrior prior = expected.prior(stamp_ns);
    plvo_prior given;
    std::memset(&given, 0x5a, sizeof given);
    given.struct_size = sizeof given;
    ASSERT_EQ(plvo_imu_prior(imu, stamp_ns, &given).code, PLVO_OK);
    EXPECT_EQ(given.struct_size, sizeof given);
    ASSERT_EQ(given.has_rotation != 0, i > 0 && i < 4);
    EXPECT_EQ(given.has_rotation != 0, prior.rotation.has_value());
    EXPECT_EQ(given.has_translation, 0);
    ASSERT_TRUE(prior.gravity && given.has_gravity == 1);
    if (prior.rotation) {
      expect_same(prior.rotation->R_now_before, given.R_now_before);
      expect_same(prior.rotation->covariance, given.rotation_covariance);
    }
    expect_same(prior.gravity->down, given.down);
    expect_same(prior.gravity->covariance, given.gravity_covariance);
    EXPECT_TRUE(same_bits(prior.gravity->offset_sigma, given.gravity_offset_sigma));
  }
}

TEST_F(CImu, TakesNoMemory) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "SKIPPED: a sanitizer owns malloc here";
  ASSERT_EQ(init(nullptr).code, PLVO_OK);
  const ImuReading reading = imu_readings(0).back();
  plvo_prior prior;
  plvo_prior_init(&prior, sizeof prior);
  AllocationGuard guard;
  guard.arm();
  EXPECT_EQ(plvo_imu_add_gyro(imu, reading.stamp_ns, reading.rate.data()).code, PLVO_OK);
  EXPECT_EQ(plvo_imu_prior(imu, reading.stamp_ns, &prior).code, PLVO_OK);
  guard.disarm();
  EXPECT_EQ(guard.calls(), 0);
}

TEST_F(CImu, AMissingSensorGivesNoPrior) {
  plvo_imu_config config = default_imu_config();
  config.accelerometer_samples = 0;
  EXPECT_LT(plvo_imu_required_bytes(&config), plvo_imu_required_bytes(nullptr));
  ASSERT_EQ(init(&config).code, PLVO_OK);
  for (const ImuReading& reading : imu_readings(0)) {
    EXPECT_EQ(plvo_imu_add_gyro(imu, reading.stamp_ns, reading.rate.data()).code, PLVO_OK);
    expect_says(plvo_imu_add_acceleration(imu, reading.stamp_ns, reading.force.data()), "memory");
  }
  plvo_prior prior;
  plvo_prior_init(&prior, sizeof prior);
  ASSERT_EQ(plvo_imu_prior(imu, ProceduralSequence::stamp_ns(0), &prior).code, PLVO_OK);
  EXPECT_EQ(prior.has_gravity, 0);
}

TEST_F(CImu, RefusesInvalidArguments) {
  ASSERT_EQ(init(nullptr).code, PLVO_OK);
  add(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double zero[3] = {0, 0, 0}, broken[3] = {0, nan, 0};
  const std::int64_t stamp_ns = ProceduralSequence::stamp_ns(0);
  expect_says(plvo_imu_add_gyro(imu, stamp_ns, zero), "later than the one before");
  expect_says(plvo_imu_add_gyro(imu, stamp_ns + 1, broken), "finite");
  expect_says(plvo_imu_add_acceleration(imu, stamp_ns, nullptr), "NULL");
  expect_says(plvo_imu_add_gyro(nullptr, stamp_ns, zero), "plvo_imu_init");
  plvo_prior prior = {};
  expect_says(plvo_imu_prior(imu, stamp_ns, &prior), "prior.struct_size");
  plvo_prior_init(&prior, sizeof prior);
  expect_says(plvo_imu_prior(imu, std::numeric_limits<std::int64_t>::min(), &prior), "stamp");
  expect_says(plvo_imu_prior(nullptr, stamp_ns, &prior), "plvo_imu_init");
  plvo_result result = {};
  expect_says(plvo_imu_learn(imu, PLVO_OK, &result), "result.struct_size");
  result.struct_size = sizeof result;
  result.state = 9;
  expect_says(plvo_imu_learn(imu, PLVO_OK, &result), "state");
  result.state = PLVO_TRACKING;
  result.T_camera_reference[3] = nan;
  EXPECT_EQ(plvo_imu_learn(imu, PLVO_OK, &result).code, PLVO_OK) << "only its rotation is learnt from";
  result.T_camera_reference[4] = nan;
  expect_says(plvo_imu_learn(imu, PLVO_OK, &result), "finite");
  expect_says(plvo_imu_learn(nullptr, PLVO_OK, &result), "plvo_imu_init");
  EXPECT_EQ(plvo_imu_gyro_offset(imu, nullptr, nullptr).code, PLVO_OK);
  expect_says(plvo_imu_gyro_offset(nullptr, nullptr, nullptr), "plvo_imu_init");

  expect_says(plvo_imu_init(nullptr, 0, nullptr, &imu), "memory is NULL");
  expect_says(plvo_imu_init(block.data(), block.size(), nullptr, nullptr), "imu is NULL");
  const plvo_status small = plvo_imu_init(block.data(), block.size() - 1, nullptr, &imu);
  EXPECT_EQ(small.code, PLVO_OUT_OF_MEMORY);
  EXPECT_NE(std::string(small.message).find(std::to_string(block.size())), std::string::npos);
  EXPECT_EQ(imu, nullptr);
  plvo_imu_config config = default_imu_config();
  config.struct_size = 8;
  expect_says(init(&config), "imu_config.struct_size");
  config = default_imu_config();
  config.gyro_samples = 1;
  expect_says(init(&config), "gyro_samples");
  config.gyro_samples = std::numeric_limits<std::int32_t>::max();
  expect_says(init(&config), "gyro_samples");
  config = default_imu_config();
  config.R_camera_imu[0] = 2;
  expect_says(init(&config), "R_camera_imu");
  EXPECT_EQ(plvo_imu_required_bytes(&config), 0U);
}

}  // namespace
}  // namespace plvo
