// SPDX-License-Identifier: Apache-2.0
// wheel_odometry.txt: written and read back, lines that are wrong, and the priors of frames between its
// samples against a slow integration.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plvo/replay/wheel_files.hpp"
#include "plvo/replay/wheel_priors.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;
using test::write_file;

constexpr std::int64_t kWheelStart = 1'600'000'000'000'000'000;
constexpr std::int64_t kWheelPeriod = 20'000'000;

Vector3 velocity_of(double t) {
  return {0.5 + 0.2 * std::sin(2 * t), 0.1 * std::cos(t), 0.8 * std::sin(3 * t)};
}

WheelRecording driven(int count, bool with_sigma = false) {
  WheelRecording recording;
  recording.has_sigma = with_sigma;
  for (int k = 0; k < count; ++k)
    recording.samples.push_back({kWheelStart + k * kWheelPeriod, velocity_of(0.02 * k),
                                 with_sigma ? Vector3(0.02, 0.01, 0.05) : Vector3(Vector3::Zero())});
  return recording;
}

TEST(WheelFiles, ReadsWhatItWrote) {
  const TemporaryFolder folder;
  for (const bool with_sigma : {false, true}) {
    const WheelRecording written = driven(40, with_sigma);
    ASSERT_TRUE(write_wheel_file(folder / kWheelFile, written).ok());
    WheelRecording read;
    const Status status = read_wheel_file(folder / kWheelFile, read);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(read.has_sigma, with_sigma);
    EXPECT_EQ(read.ignored, 0U);
    ASSERT_EQ(read.samples.size(), written.samples.size());
    for (std::size_t k = 0; k < read.samples.size(); ++k) {
      EXPECT_EQ(read.samples[k].stamp_ns, written.samples[k].stamp_ns);
      EXPECT_LT((read.samples[k].velocity - written.samples[k].velocity).norm(), 1e-6);
      EXPECT_LT((read.samples[k].sigma - written.samples[k].sigma).norm(), 1e-6);
    }
  }
}

TEST(WheelFiles, NameInvalidLinesAndSkipStampsThatDoNotIncrease) {
  const TemporaryFolder folder;
  WheelRecording read;
  const auto refused = [&](const std::string& text, StatusCode code, const std::string& words) {
    write_file(folder / "w.txt", text);
    const Status status = read_wheel_file(folder / "w.txt", read);
    EXPECT_EQ(status.code(), code) << text;
    EXPECT_NE(std::string(status.message()).find(words), std::string::npos) << status.message();
  };
  refused("1.0 0 0 0\n1.1 0 zero 0\n", StatusCode::kDamaged, "line 2: 'zero' is not a number");
  refused("1.0 0 0\n", StatusCode::kDamaged, "line 1: must have 4 columns");
  refused("# x\n1.0 0 0 0\n1.1 0 0 0 1 1 1\n", StatusCode::kDamaged, "line 3: has 7 columns where 4");
  refused("1.0 0 0 0 0.1 0.1 0\n", StatusCode::kDamaged, "greater than 0");
  refused("now 0 0 0\n", StatusCode::kDamaged, "line 1");
  refused("# nothing\n", StatusCode::kInvalidArgument, "has no sample");
  EXPECT_EQ(read_wheel_file(folder / "none.txt", read).code(), StatusCode::kNotFound);
  write_file(folder / "w.txt", "1.0 0 0 0\r\n1.0 0 0 0\n0.5 0 0 0\n1.1 nan 0 0\n1.2,0,0,1\n");
  ASSERT_TRUE(read_wheel_file(folder / "w.txt", read).ok());
  EXPECT_EQ(read.samples.size(), 2U);
  EXPECT_EQ(read.ignored, 3U);
}

// T_before_now of the base, in steps of 10 µs.
Se3 slow_drive(double from_s, double to_s) {
  constexpr double kStep = 1e-5;
  const int steps = static_cast<int>((to_s - from_s) / kStep + 0.5);
  Se3 T;
  for (int k = 0; k < steps; ++k) {
    const Vector3 v = velocity_of(from_s + (k + 0.5) * kStep);
    T.t += kStep * (T.R * Vector3(v.x(), v.y(), 0));
    T.R = T.R * rotation_exp({0, 0, kStep * v.z()});
  }
  T.R = renormalise(T.R);
  return T;
}

TEST(WheelPriors, PriorsBetweenSamplesEqualTheDrivenMotion) {
  WheelConfig config;
  config.T_base_camera = {rotation_exp({0.3, -1, 0.2}), {0.3, 0.1, 0.4}};
  WheelPriors wheels;
  ASSERT_TRUE(wheels.init(driven(150), config).ok());
  EXPECT_FALSE(wheels.prior(kWheelStart + 5'000'000).tells_motion()) << "there is no frame before";
  for (int i = 1; i < 40; ++i) {
    const double before = 0.005 + (i - 1) * 0.0333, now = 0.005 + i * 0.0333;
    const MotionPrior prior = wheels.prior(kWheelStart + std::llround(now * 1e9));
    ASSERT_TRUE(prior.rotation && prior.translation) << i;
    const Se3 expected =
        config.T_base_camera.inverse() * slow_drive(before, now).inverse() * config.T_base_camera;
    const Se3 T{prior.rotation->R_now_before, prior.translation->t_now_before};
    EXPECT_LT(boxminus(T, expected).cwiseAbs().maxCoeff(), 2e-5) << i;
    EXPECT_TRUE(prior.validate().ok());
  }
  EXPECT_EQ(wheels.priors(), 39U);
}

TEST(WheelPriors, StandardDeviationsOfTheFileComeBeforeTheShareOfTheSpeed) {
  WheelConfig config;
  config.error_s = 0;
  const auto prior_at = [&](bool with_sigma, double share) {
    config.share = share;
    WheelPriors wheels;
    EXPECT_TRUE(wheels.init(driven(20, with_sigma), config).ok());
    (void)wheels.prior(kWheelStart);
    return wheels.prior(kWheelStart + kWheelPeriod);
  };
  const MotionPrior stated = prior_at(true, 0.5), exact = prior_at(false, 0), sloppy = prior_at(false, 0.5);
  EXPECT_NEAR(std::sqrt(stated.translation->covariance(0, 0)), 0.02 * 0.02, 1e-5);
  EXPECT_NEAR(std::sqrt(stated.rotation->covariance(2, 2)), 0.02 * 0.05, 1e-5);
  EXPECT_NEAR(std::sqrt(exact.translation->covariance(0, 0)), 0.02 * config.least_mps, 1e-5);
  EXPECT_NEAR(std::sqrt(sloppy.translation->covariance(0, 0)), 0.02 * (0.5 * 0.51 + config.least_mps), 2e-4);
  EXPECT_NEAR(std::sqrt(sloppy.rotation->covariance(2, 2)), 0.02 * (config.least_rps + 0.51 + 0.5 * 0.024),
              2e-4);
}

TEST(WheelPriors, GiveNoPriorWhereSamplesAreMissing) {
  WheelRecording recording = driven(100);
  recording.samples.erase(recording.samples.begin() + 30, recording.samples.begin() + 50);  // 0.4 s
  WheelPriors wheels;
  ASSERT_TRUE(wheels.init(recording, {}).ok());
  const auto told = [&](double s) {
    return wheels.prior(kWheelStart + std::llround(s * 1e9)).tells_motion();
  };
  EXPECT_FALSE(told(-0.1));
  EXPECT_FALSE(told(0.1)) << "the samples begin in between";
  EXPECT_TRUE(told(0.5));
  EXPECT_FALSE(told(0.7)) << "a gap";
  EXPECT_FALSE(told(1.1));
  EXPECT_TRUE(told(1.5));
  EXPECT_FALSE(told(1.4)) << "backwards";
  EXPECT_TRUE(told(1.6));
  EXPECT_FALSE(told(2.5)) << "they have ended";
  EXPECT_FALSE(told(2.6));
}

// One after the other they give the priors of the whole recording, bit for bit; out of turn they are left
// out.
TEST(WheelPriors, SamplesThatComeOneByOneAreThoseOfARecording) {
  WheelPriors whole, one_by_one;
  ASSERT_TRUE(whole.init(driven(100), {}).ok());
  ASSERT_TRUE(one_by_one.init({}, {}).ok());
  EXPECT_FALSE(one_by_one.last_ns());
  const std::vector<WheelSample> samples = driven(100).samples;
  std::size_t next = 0;
  for (int i = 0; i < 50; ++i) {
    const std::int64_t stamp_ns = kWheelStart + 7'000'000 + i * 33'000'000;
    while (next < samples.size() && one_by_one.last_ns() < stamp_ns)
      EXPECT_TRUE(one_by_one.add(samples[next++]));
    const MotionPrior expected = whole.prior(stamp_ns), prior = one_by_one.prior(stamp_ns);
    ASSERT_EQ(prior.tells_motion(), i > 0) << i;
    ASSERT_EQ(expected.tells_motion(), i > 0) << i;
    if (i == 0) continue;
    EXPECT_EQ(prior.translation->t_now_before, expected.translation->t_now_before);
    EXPECT_EQ(prior.rotation->R_now_before, expected.rotation->R_now_before);
    EXPECT_EQ(prior.translation->covariance, expected.translation->covariance);
  }
  EXPECT_FALSE(one_by_one.add(samples[next - 1])) << "not later";
  EXPECT_FALSE(one_by_one.add({kWheelStart * 2, {std::nan(""), 0, 0}, Vector3::Zero()}));
}

TEST(WheelPriors, TheLastVelocityIsHeldForAWhileWithAGrowingCovariance) {
  const auto prior_of = [](double hold_s, int samples, double stamp_s) {
    WheelConfig config;
    config.hold_s = hold_s;
    WheelPriors wheels;
    EXPECT_TRUE(wheels.init(driven(samples), config).ok());
    (void)wheels.prior(kWheelStart + 950'000'000);
    return wheels.prior(kWheelStart + std::llround(stamp_s * 1e9));
  };
  // The last of 50 samples is at 0.98 s.
  EXPECT_FALSE(prior_of(0, 50, 1.05).tells_motion());
  EXPECT_FALSE(prior_of(0.1, 50, 1.09).tells_motion());
  const MotionPrior held = prior_of(0.1, 50, 1.05), told = prior_of(0.1, 100, 1.05);
  ASSERT_TRUE(held.tells_motion() && told.tells_motion());
  EXPECT_TRUE(held.validate().ok());
  const Vector3 off = held.translation->t_now_before - told.translation->t_now_before;
  EXPECT_GT(off.norm(), 0);
  const Matrix3 sigma = held.translation->covariance;
  for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(off[k]), 3 * std::sqrt(sigma(k, k))) << off.transpose();
  EXPECT_GT(sigma(0, 0), 1.2 * told.translation->covariance(0, 0));
  EXPECT_GT(held.rotation->covariance(2, 2), 1.2 * told.rotation->covariance(2, 2));
}

TEST(WheelPriors, TheOldestSamplesAreForgotten) {
  WheelPriors wheels;
  ASSERT_TRUE(wheels.init({}, {}).ok());
  const auto stamp_of = [](std::size_t k) {
    return kWheelStart + static_cast<std::int64_t>(k) * kWheelPeriod;
  };
  for (std::size_t k = 0; k < WheelPriors::kMostSamples; ++k)
    ASSERT_TRUE(wheels.add({stamp_of(k), {0.5, 0, 0}, Vector3::Zero()}));
  (void)wheels.prior(stamp_of(WheelPriors::kMostSamples - 5));
  ASSERT_TRUE(wheels.add({stamp_of(WheelPriors::kMostSamples), {0.5, 0, 0}, Vector3::Zero()}));
  const MotionPrior prior = wheels.prior(stamp_of(WheelPriors::kMostSamples - 2));
  ASSERT_TRUE(prior.translation);
  EXPECT_NEAR(prior.translation->t_now_before.norm(), 0.03, 1e-9);
}

TEST(WheelPriors, RefuseAnInvalidConfiguration) {
  const auto refused = [](auto spoil, const char* word) {
    WheelConfig config;
    spoil(config);
    WheelPriors wheels;
    const Status status = wheels.init(driven(3), config);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_NE(std::string(status.message()).find(word), std::string::npos) << status.message();
  };
  refused([](WheelConfig& c) { c.T_base_camera.R *= 2; }, "T_base_camera");
  refused([](WheelConfig& c) { c.share = -1; }, "share");
  refused([](WheelConfig& c) { c.track_m = 0; }, "track_m");
  refused([](WheelConfig& c) { c.tilt_rps = 0; }, "standard deviation");
  refused([](WheelConfig& c) { c.tilt_rps = std::nan(""); }, "standard deviation");
  refused([](WheelConfig& c) { c.error_s = std::nan(""); }, "error_s");
  refused([](WheelConfig& c) { c.longest_gap_s = 0; }, "longest_gap_s");
  refused([](WheelConfig& c) { c.hold_s = 1; }, "hold_s");
  refused([](WheelConfig& c) { c.acceleration_rps2 = std::nan(""); }, "an acceleration");
}

}  // namespace
}  // namespace plvo
