// SPDX-License-Identifier: Apache-2.0
// gyroscope.txt and accelerometer.txt: written and read back, invalid lines reported, and the samples
// delivered with their frames.
#include <gtest/gtest.h>

#include <cmath>

#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/recorded_imu.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;
using test::write_file;

constexpr std::int64_t kStart = 1'305'031'098'000'000'000;

ImuRecording recording(int count) {
  ImuRecording result;
  for (int k = 0; k < count; ++k) {
    result.gyro.push_back({kStart + k * 5'000'000LL, {0.1, -0.2 * std::sin(0.1 * k), 0.3}});
    result.accelerometer.push_back({kStart + k * 5'000'000LL, {0.01 * k, -9.8, 0}});
  }
  return result;
}

TEST(ImuFiles, ReadsWhatItWrote) {
  const TemporaryFolder folder;
  const ImuRecording written = recording(50);
  ASSERT_TRUE(write_imu_files(folder.path(), written).ok());
  ImuRecording read;
  const Status status = read_imu_files(folder.path(), read);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(read.gyro.size(), written.gyro.size());
  ASSERT_EQ(read.accelerometer.size(), written.accelerometer.size());
  for (std::size_t k = 0; k < written.gyro.size(); ++k) {
    EXPECT_EQ(read.gyro[k].stamp_ns, written.gyro[k].stamp_ns);
    EXPECT_LT((read.gyro[k].value - written.gyro[k].value).norm(), 1e-7);
    EXPECT_LT((read.accelerometer[k].value - written.accelerometer[k].value).norm(), 1e-7);
  }
  EXPECT_EQ(read.ignored, 0U);
}

TEST(ImuFiles, KeepAllDigitsOfRecordedSamples) {
  const TemporaryFolder folder;
  ImuRecording written = recording(20);
  ASSERT_TRUE(refuse_imu_files(folder.path()).ok());
  ASSERT_TRUE(write_imu_files(folder.path(), written, ImuAxes::kSensor).ok());
  ImuRecording read;
  ASSERT_TRUE(read_imu_files(folder.path(), read).ok());
  ASSERT_EQ(read.gyro.size(), written.gyro.size());
  for (std::size_t k = 0; k < written.gyro.size(); ++k) EXPECT_EQ(read.gyro[k].value, written.gyro[k].value);
  EXPECT_NE(test::read_file(folder / "gyroscope.txt").find("rad/s, axes of the sensor"), std::string::npos);
  const Status refused = refuse_imu_files(folder.path());
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(refused.message()).find("has gyroscope.txt already"), std::string::npos);
  // A missing sensor gets no file.
  const TemporaryFolder other;
  written.gyro.clear();
  ASSERT_TRUE(write_imu_files(other.path(), written, ImuAxes::kSensor).ok());
  EXPECT_FALSE(std::filesystem::exists(other / "gyroscope.txt"));
}

TEST(ImuFiles, RequireAtLeastOneFile) {
  const TemporaryFolder folder;
  ImuRecording read;
  Status status = read_imu_files(folder.path(), read);
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_NE(std::string(status.message()).find("accelerometer.txt"), std::string::npos);
  // In the form that TUM publishes.
  write_file(folder / "accelerometer.txt",
             "# accelerometer data\n# timestamp ax ay az\n1305031098.679604 -0.1 9.7 1.5\n"
             "1305031098.681604 -0.2 9.8 1.4\n");
  status = read_imu_files(folder.path(), read);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(read.accelerometer.size(), 2U);
  EXPECT_TRUE(read.gyro.empty());
  EXPECT_EQ(read.accelerometer[1].stamp_ns, 1'305'031'098'681'604'000);
}

TEST(ImuFiles, ReportInvalidLinesAndSkipInvalidStamps) {
  const TemporaryFolder folder;
  ImuRecording read;
  write_file(folder / "gyroscope.txt", "1.0 0 0 0\n1.1 0 zero 0\n");
  Status status = read_imu_files(folder.path(), read);
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_NE(std::string(status.message()).find("line 2"), std::string::npos) << status.message();
  write_file(folder / "gyroscope.txt", "1.0 0 0 0\n1.1 0 0\n");
  EXPECT_EQ(read_imu_files(folder.path(), read).code(), StatusCode::kDamaged);
  write_file(folder / "gyroscope.txt", "now 0 0 0\n");
  EXPECT_EQ(read_imu_files(folder.path(), read).code(), StatusCode::kDamaged);
  write_file(folder / "gyroscope.txt", "1.0 0 0 0\n1.0 0 0 0\n0.5 0 0 0\n1.1 nan 0 0\n1.2 0 0 1\n");
  ASSERT_TRUE(read_imu_files(folder.path(), read).ok());
  EXPECT_EQ(read.gyro.size(), 2U);
  EXPECT_EQ(read.ignored, 3U);
}

// The integrator gets the same samples from the recording as from a live sensor.
TEST(RecordedImu, EqualsALiveSensor) {
  const ImuRecording all = recording(100);
  RecordedImu recorded;
  ASSERT_TRUE(recorded.init(all, {}).ok());
  std::vector<ImuSample> gyro(64), accelerometer(64);
  ImuIntegrator live;
  ASSERT_TRUE(live.init(gyro, accelerometer, {}).ok());
  std::size_t next = 0;
  for (std::int64_t stamp = kStart + 20'000'000; stamp < kStart + 480'000'000; stamp += 33'333'333) {
    for (bool after = false; next < all.gyro.size() && !after; ++next) {
      after = all.gyro[next].stamp_ns > stamp;
      (void)live.add_gyro(all.gyro[next]);
      (void)live.add_acceleration(all.accelerometer[next]);
    }
    const MotionPrior a = recorded.until(stamp).prior(stamp), b = live.prior(stamp);
    ASSERT_EQ(a.rotation.has_value(), b.rotation.has_value());
    if (a.rotation) {
      EXPECT_EQ(a.rotation->R_now_before, b.rotation->R_now_before);
      EXPECT_EQ(a.rotation->covariance, b.rotation->covariance);
    }
    ASSERT_TRUE(a.gravity && b.gravity);
    EXPECT_EQ(a.gravity->down, b.gravity->down);
  }
}

}  // namespace
}  // namespace plvo
