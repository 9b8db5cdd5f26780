// SPDX-License-Identifier: Apache-2.0
// What a gyro and an accelerometer recorded, for C; and the program of docs/user/c.md that tracks with it, as
// C++ does.
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "command.hpp"
#include "moving_imu.hpp"
#include "plvo/c/sequence.h"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "plvo/replay/recorded_imu.hpp"
#include "plvo/replay/tum_writer.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

constexpr int kRecordedFrames = 7, kDark = 5;

class CRecordedImu : public testing::Test {
 protected:
  void SetUp() override {
    ProceduralSequence rendered(320, 240);
    TumWriter writer;
    ASSERT_TRUE(writer.open(recording(), rendered.camera(), 1000).ok());
    for (int i = 0; i < kRecordedFrames; ++i) {
      ASSERT_TRUE(writer.write(i == kDark ? rendered.render_dark(i) : rendered.render(i)).ok());
      for (const ImuReading& reading : imu_readings(i)) {
        recorded_.gyro.push_back({reading.stamp_ns, reading.rate});
        recorded_.accelerometer.push_back({reading.stamp_ns, reading.force});
      }
    }
    ASSERT_TRUE(write_imu_files(recording(), recorded_, ImuAxes::kSensor).ok());
  }
  void TearDown() override { plvo_sequence_close(sequence_); }
  std::filesystem::path recording() const { return folder_ / "sequence"; }
  plvo_status read(plvo_imu_readings& readings) {
    plvo_sequence_close(sequence_);
    EXPECT_EQ(plvo_sequence_open(recording().c_str(), nullptr, &sequence_).code, PLVO_OK);
    return plvo_sequence_imu(sequence_, &readings);
  }
  static plvo_imu_readings empty() {
    plvo_imu_readings readings;
    std::memset(&readings, 0xff, sizeof readings);  // whatever stood there
    readings.struct_size = sizeof readings;
    return readings;
  }
  static void expect_same(const plvo_imu_sample* samples, std::size_t count,
                          const std::vector<ImuSample>& expected) {
    ASSERT_EQ(count, expected.size());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(samples[i].stamp_ns, expected[i].stamp_ns);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(samples[i].value[k], expected[i].value[k]);
    }
  }

  test::TemporaryFolder folder_;
  ImuRecording recorded_;
  plvo_sequence* sequence_ = nullptr;
};

TEST_F(CRecordedImu, GivesWhatTheFolderHas) {
  plvo_imu_readings readings = empty();
  plvo_status status = read(readings);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  expect_same(readings.gyro, readings.gyro_count, recorded_.gyro);
  expect_same(readings.accelerometer, readings.accelerometer_count, recorded_.accelerometer);
  EXPECT_EQ(readings.left_out, 0U);
  EXPECT_EQ(readings.struct_size, sizeof readings);

  std::filesystem::remove(recording() / kGyroFile);
  readings = empty();
  status = read(readings);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  EXPECT_EQ(readings.gyro, nullptr);
  EXPECT_EQ(readings.gyro_count, 0U);
  expect_same(readings.accelerometer, readings.accelerometer_count, recorded_.accelerometer);

  test::write_file(recording() / kAccelerometerFile, "2 0 9.8 0\n1 0 9.8 0\n3 0 nan 0\n4 0 9.7 0\n");
  ASSERT_EQ(read(readings).code, PLVO_OK);
  EXPECT_EQ(readings.accelerometer_count, 2U);
  EXPECT_EQ(readings.left_out, 2U);
}

TEST_F(CRecordedImu, ReportsErrorsAndGivesNoPrior) {
  test::write_file(recording() / kGyroFile, "1 0 0 0\n2 0 zero 0\n");
  plvo_imu_readings readings = empty();
  plvo_status status = read(readings);
  EXPECT_EQ(status.code, PLVO_DAMAGED);
  EXPECT_NE(std::strstr(status.message, "gyroscope.txt line 2: 'zero' is not a number"), nullptr)
      << status.message;
  EXPECT_EQ(readings.gyro, nullptr);
  EXPECT_EQ(readings.gyro_count + readings.accelerometer_count + readings.left_out, 0U);

  std::filesystem::remove(recording() / kGyroFile);
  std::filesystem::remove(recording() / kAccelerometerFile);
  status = read(readings);
  EXPECT_EQ(status.code, PLVO_NOT_FOUND);
  EXPECT_NE(std::strstr(status.message, "has neither gyroscope.txt nor accelerometer.txt"), nullptr);
  readings.struct_size = 8;
  status = plvo_sequence_imu(sequence_, &readings);
  EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(status.message, "set it to sizeof(plvo_imu_readings)"), nullptr) << status.message;
  EXPECT_EQ(plvo_sequence_imu(sequence_, nullptr).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_sequence_imu(nullptr, &readings).code, PLVO_INVALID_ARGUMENT);
}

// To the nine decimals that the program prints.
TEST_F(CRecordedImu, TheProgramOfThePageGivesThePosesOfCpp) {
  Calibration calibration;
  ASSERT_TRUE(read_calibration(recording() / "calibration.txt", calibration).ok());
  RecordedCamera camera;
  ASSERT_TRUE(camera.open(recording(), calibration).ok());
  RecordedImu imu;
  ASSERT_TRUE(imu.init(recorded_, {}).ok());
  const Limits limits{320, 240};
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, camera.model(), {}, limits).ok());
  std::vector<std::string> expected;
  for (RgbdFrame frame; camera.next(frame).ok();) {
    const TrackResult result = odometry.track(frame, imu.until(frame.stamp_ns));
    EXPECT_EQ(result.state == TrackState::kPredicted, expected.size() == kDark) << expected.size();
    const std::string line = trajectory_line(result.stamp_ns, result.T_world_camera);
    expected.push_back(line.substr(line.find(' ')));
  }

  const test::CommandResult run =
      test::run_command(std::string(PLVO_C_IMU_EXAMPLE) + ' ' + recording().string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(run.out);
  std::vector<std::string> poses;
  for (std::string line; std::getline(lines, line);) poses.push_back(line.substr(line.find(' ')));
  EXPECT_EQ(poses, expected);
  EXPECT_EQ(poses.size(), std::size_t{kRecordedFrames});
  EXPECT_EQ(test::run_command(PLVO_C_IMU_EXAMPLE).exit_code, 2);
  std::filesystem::remove(recording() / kGyroFile);
  std::filesystem::remove(recording() / kAccelerometerFile);
  const test::CommandResult none =
      test::run_command(std::string(PLVO_C_IMU_EXAMPLE) + ' ' + recording().string());
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_EQ(none.err.rfind("not_found: ", 0), 0U) << none.err;
}

}  // namespace
}  // namespace plvo
