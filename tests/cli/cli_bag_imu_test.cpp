// SPDX-License-Identifier: Apache-2.0
// `plvo run --imu` of a ROS 1 bag gives the bytes of the folder with the same readings, whichever topics hold
// them. Ambiguous topics give a message.
#include <gtest/gtest.h>

#include "bag_of_folder.hpp"
#include "plvo_command.hpp"
#include "recorded_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::ImuContent;
using test::read_file;
using test::recorded_sequence;
using test::RecordedMessage;
using test::write_file;
using Messages = std::vector<RecordedMessage>;

class CliBagImu : public test::PlvoCommand {
 protected:
  static Messages readings(const std::string& topic, ImuContent content) {
    return test::published_imu(recorded_sequence(), topic, content);
  }
  void write(const std::vector<Messages>& readings) const {
    Messages all;
    for (const Messages& part : readings) all.insert(all.end(), part.begin(), part.end());
    const Messages images = test::published(recorded_sequence(), true);
    all.insert(all.end(), images.begin(), images.end());
    write_file(folder_ / "recording.bag", test::bag_of(all, "lz4"));
  }
  CommandResult run(const std::string& recording, const std::string& options) const {
    return plvo("run " + recording + " --readout 0 --quiet --out " + path("t") + " --covariance " +
                path("c") + ' ' + options);
  }
  // Trajectory and covariances.
  std::string bytes_of(const std::string& recording, const std::string& options) const {
    const CommandResult r = run(recording, options);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return read_file(folder_ / "t") + read_file(folder_ / "c");
  }
  void expect_refused(const std::string& options, int exit_code, const std::string& words) const {
    PlvoCommand::expect_refused(run(path("recording.bag"), options), exit_code, words);
  }
};

TEST_F(CliBagImu, EqualsTheBytesOfTheFolder) {
  const std::string expected = bytes_of(recorded_sequence().string(), "--imu");
  EXPECT_NE(expected, bytes_of(recorded_sequence().string(), "")) << "the readings matter";
  write({readings("/imu", ImuContent::kBoth)});
  EXPECT_EQ(bytes_of(path("recording.bag"), "--imu"), expected);
  EXPECT_EQ(bytes_of(path("recording.bag"), "--imu --imu-axes x,-y,-z"),
            bytes_of(recorded_sequence().string(), "--imu --imu-axes x,-y,-z"));
  // Sorted by stamp, whatever the order in the file.
  Messages backwards = readings("/imu", ImuContent::kBoth);
  std::reverse(backwards.begin(), backwards.end());
  write({backwards});
  EXPECT_EQ(bytes_of(path("recording.bag"), "--imu"), expected);
  write({readings("/camera/gyro/sample", ImuContent::kGyroAlone),
         readings("/camera/accel/sample", ImuContent::kAccelerationAlone)});
  EXPECT_EQ(bytes_of(path("recording.bag"), "--imu"), expected);
}

TEST_F(CliBagImu, UsesAnAccelerometerAlone) {
  fs::copy(recorded_sequence(), folder_ / "still", fs::copy_options::recursive);
  fs::remove(folder_ / "still/gyroscope.txt");
  const std::string expected = bytes_of(path("still"), "--imu");
  for (const ImuContent content : {ImuContent::kAcceleration, ImuContent::kAccelerationAlone}) {
    write({readings("/imu", content)});
    EXPECT_EQ(bytes_of(path("recording.bag"), "--imu"), expected);
    expect_refused("--imu", 0, "no gyro: gravity alone helps");
  }
}

TEST_F(CliBagImu, ChoosesOneOfSeveralTopicsByName) {
  const std::string expected = bytes_of(recorded_sequence().string(), "--imu");
  Messages other = readings("/base/imu", ImuContent::kBoth);
  for (std::size_t i = 0; i < other.size(); i += 2) other[i].data.resize(100);
  write({other, readings("/camera/imu", ImuContent::kBoth)});
  expect_refused(
      "--imu", 1,
      "several topics have readings of a gyro: choose with --gyro-topic or topics.gyro; they are on "
      "/base/imu, /camera/imu");
  expect_refused("--imu --gyro-topic /camera/imu", 1, "choose with --accelerometer-topic");
  EXPECT_EQ(
      bytes_of(path("recording.bag"), "--imu --gyro-topic /camera/imu --accelerometer-topic /camera/imu"),
      expected);
  // Damaged messages are left out and counted.
  expect_refused("--imu --gyro-topic /base/imu --accelerometer-topic /base/imu", 0,
                 std::to_string((other.size() + 1) / 2) + " readings of gyro and accelerometer left out");
  expect_refused(
      "--imu --gyro-topic /imu", 1,
      "there are no readings of a gyro (sensor_msgs/Imu) on /imu; they are on /base/imu, /camera/imu");
}

TEST_F(CliBagImu, ReportsMissingReadings) {
  write({});
  expect_refused("--imu", 1, "the bag has no readings of a gyro or an accelerometer");
  expect_refused("--imu --accelerometer-topic /tf", 1,
                 "there are no readings of an accelerometer (sensor_msgs/Imu) on /tf; no topic has");
  expect_refused("--gyro-topic /imu", 2, "--gyro-topic: is for --imu");
  const CommandResult folder = run(recorded_sequence().string(), "--imu --gyro-topic /imu");
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_NE(folder.err.find("--gyro-topic: is for a ROS bag"), std::string::npos) << folder.err;
}

}  // namespace
}  // namespace plvo
